#include "client/cli/exchange_commands.hpp"

#include <ostream>
#include <string>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/files/output_file.hpp"

namespace kinship::cli {
namespace {

/// Where rows go.
struct RowsTarget {
  const std::filesystem::path& file;  ///< empty: a stream
  files::OutputFile& output;          ///< to it
  bool progress;                      ///< is told
};

/// Writes rows as lines; the file has its name only if all came.
int write_rows(link::Client& server, const AdminRequest& request, const RowsTarget& target,
               std::string_view command, std::ostream& err) {
  constexpr std::size_t kLinesAtOnce = 100;
  StatusLine progress(err, target.progress);
  std::size_t lines = 0;
  const auto error = link::for_each_row(server, request, [&](const std::string& row) {
    target.output.stream() << row << '\n';
    if (++lines % kLinesAtOnce == 0)
      progress.show(std::string(command) + ": " + count_text(lines, "line"));
    return target.output.stream().good();
  });
  progress.clear();
  if (error)
    return refuse(command, *error, err);
  target.output.keep();
  if (!target.file.empty())
    err << count_text(lines, "line") << " in '" << target.file.string() << "'\n";
  return kDone;
}

}  // namespace

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
    const bool progress = options.waiting.progress && !(options.output.empty() && is_terminal(out));
    return write_rows(server, rows, {options.output, output, progress}, kCommand, err);
  });
}

}  // namespace kinship::cli
