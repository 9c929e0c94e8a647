#include "client/cli/export_commands.hpp"

#include <ostream>

#include "client/cli/admin_rows.hpp"
#include "client/cli/table.hpp"
#include "client/cli/terminal.hpp"
#include "client/files/output_file.hpp"
#include "client/link/admin_rows.hpp"

namespace kinship::cli {
namespace {

/// Writes rows as lines; the file has its name only if all came.
/// \param file  of `output`; empty: a stream.
int write_rows(link::Client& server, const AdminRequest& request, const std::filesystem::path& file,
               files::OutputFile& output, std::string_view command, StatusLine& progress,
               std::ostream& err) {
  constexpr std::size_t kLinesAtOnce = 100;
  std::size_t lines = 0;
  const auto error = link::for_each_row(server, request, [&](const std::string& row) {
    output.stream() << row << '\n';
    if (++lines % kLinesAtOnce == 0)
      progress.show(std::string(command) + ": " + count_text(lines, "line"));
    return output.stream().good();
  });
  progress.clear();
  if (error)
    return refuse(command, *error, err);
  output.keep();
  if (!file.empty())
    err << count_text(lines, "line") << " in '" << file.string() << "'\n";
  return kDone;
}

}  // namespace

int export_paths(link::Client& server, const ExportOptions& options, std::ostream& out,
                 std::ostream& err) {
  files::OutputFile output(options.output, out);
  AdminRequest request;
  request.verb = AdminVerb::ExportPaths;
  request.robot = options.robot;
  request.task = options.task;
  StatusLine progress(err, options.progress && !(options.output.empty() && is_terminal(out)));
  return write_rows(server, request, options.output, output, "paths export", progress, err);
}

int export_configurations(link::Client& server, const ConfigurationsOptions& options,
                          std::ostream& out, std::ostream& err) {
  constexpr const char* kCommand = "configurations export";
  files::OutputFile output(options.output, out);  // refuses before the server has worked for it
  int code = kDone;
  AdminRequest begin;
  begin.verb = AdminVerb::ExportConfigurations;
  begin.argument = id_of_query(server, options.query, kCommand, false, err, code);
  if (code != kDone)
    return code;
  return run_job(server, begin, options.waiting, kCommand, err, [&](const Job& job) {
    AdminRequest rows;
    rows.verb = AdminVerb::JobRows;
    rows.argument = job.id;
    StatusLine progress(err,
                        options.waiting.progress && !(options.output.empty() && is_terminal(out)));
    return write_rows(server, rows, options.output, output, kCommand, progress, err);
  });
}

}  // namespace kinship::cli
