#include "client/cli/admin_rows.hpp"

#include <ostream>

#include "client/link/admin_rows.hpp"

namespace kinship::cli {

int refuse(std::string_view command, const Error& error, std::ostream& err) {
  err << command << ": " << error.message << '\n';
  return exit_code(error.code);
}

int for_each_row(link::Client& server, AdminVerb verb, const ListOptions& options,
                 std::string_view command, std::ostream& err,
                 const std::function<bool(const std::string& row)>& use) {
  AdminRequest request;
  request.verb = verb;
  request.robot = options.robot;
  request.task = options.task;
  const auto error = link::for_each_row(server, request, use, options.limit);
  return error ? refuse(command, *error, err) : kDone;
}

int print_rows_as_json(link::Client& server, AdminVerb verb, const ListOptions& options,
                       std::string_view command, std::ostream& out, std::ostream& err) {
  std::string document = "{\"rows\":[";
  bool first = true;
  const int code = for_each_row(server, verb, options, command, err, [&](const std::string& row) {
    document += first ? "\n" : ",\n";
    document += row;
    first = false;
    return true;
  });
  if (code == kDone)
    out << document << "\n]}\n";
  return code;
}

std::vector<std::string> show_rows(link::Client& server, AdminVerb verb,
                                   const std::string& argument, std::string_view command,
                                   std::ostream& err, int& code) {
  AdminRequest request;
  request.verb = verb;
  request.argument = argument;
  Result<std::vector<std::string>> rows = link::rows_of(server, request);
  code = rows ? kDone : refuse(command, rows.error(), err);
  if (rows && rows->empty())
    code = refuse(command, {ErrorCode::Internal, "the server answered with nothing"}, err);
  return rows ? *std::move(rows) : std::vector<std::string>();
}

}  // namespace kinship::cli
