#include "client/cli/admin_rows.hpp"

#include <algorithm>
#include <ostream>
#include <vector>

#include "client/cli/exit_code.hpp"

namespace kinship::cli {
namespace {

constexpr std::size_t kRowsPerPage = 200;

/// Prints why there is no page. \return an exit code, kDone if there is one.
int judge(const Result<AdminReply>& reply, std::string_view command, std::ostream& err) {
  if (!reply) {
    err << command << ": " << reply.error().message << '\n';
    return exit_code(reply.error().code);
  }
  if (reply->status != AdminStatus::Ok)
    err << command << ": " << reply->message << '\n';
  return exit_code(reply->status);
}

}  // namespace

int for_each_row(link::Client& server, AdminVerb verb, const ListOptions& options,
                 std::string_view command, std::ostream& err,
                 const std::function<bool(const std::string& row)>& use) {
  AdminRequest request;
  request.verb = verb;
  request.robot = options.robot;
  request.task = options.task;
  std::size_t rows_left = options.limit == 0 ? static_cast<std::size_t>(-1) : options.limit;
  while (rows_left > 0) {
    request.limit = static_cast<std::uint32_t>(std::min(rows_left, kRowsPerPage));
    const auto reply = server.admin(request);
    if (const int code = judge(reply, command, err); code != kDone)
      return code;
    for (const std::string& row : reply->rows)
      if (rows_left-- == 0 || !use(row))
        return kDone;
    if (reply->next_cursor.empty())
      break;
    request.cursor = reply->next_cursor;
  }
  return kDone;
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
  const auto reply = server.admin(request);
  code = judge(reply, command, err);
  if (code != kDone)
    return {};
  return reply->rows;
}

}  // namespace kinship::cli
