#include "client/cli/backup_commands.hpp"

#include <cstdint>
#include <ostream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "client/link/backup_download.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {

using tables::Fit;
using tables::Table;

int back_up(link::Client& server, const BackupOptions& options, std::ostream& out,
            std::ostream& err) {
  constexpr const char* kCommand = "backup";
  AdminRequest request;
  request.verb = AdminVerb::Backup;
  request.argument = options.name;
  if (options.wait)
    return run_job(server, request, options.waiting, kCommand, err, [&](const Job& job) {
      print(job, options.json, out);
      return kDone;
    });
  const Result<Job> job = link::job_of(server, request);
  if (!job)
    return refuse(kCommand, job.error(), err);
  print(*job, options.json, out);
  return kDone;
}

int list_backups(link::Client& server, const ListOptions& options, std::ostream& out,
                 std::ostream& err) {
  constexpr const char* kCommand = "backup list";
  if (options.json)
    return print_rows_as_json(server, AdminVerb::ListBackups, options, kCommand, out, err);
  Table table({"NAME", "SIZE", "AGE", {"WRITTEN", Fit::Wide}});
  int broken = kDone;
  const int code = for_each_row(
      server, AdminVerb::ListBackups, options, kCommand, err, [&](const std::string& row) {
        const Result<BackupSummary> backup = json::backup_summary_from_json(row);
        if (!backup) {
          broken = refuse(kCommand, backup.error(), err);
          return false;
        }
        table.add_row({backup->name, size_text(backup->bytes),
                       age_text(backup->modified_ms, now_ms()), time_text(backup->modified_ms)});
        return true;
      });
  if (code == kDone && broken == kDone)
    table.print(out);
  return code == kDone ? broken : code;
}

int download_backup(link::Client& server, const DownloadOptions& options, std::ostream& out,
                    std::ostream& err) {
  constexpr const char* kCommand = "backup download";
  link::BackupDownload download{
      .name = options.name,
      .file = options.to.empty() ? std::filesystem::path(options.name) : options.to,
      .patience = options.patience};
  StatusLine progress(err, options.progress);
  download.on_progress = [&progress](std::uint64_t here, std::uint64_t of) {
    progress.show(of == 0 ? "the server reads it through"
                          : size_text(here) + " of " + size_text(of));
  };
  try {
    const Result<link::DownloadedBackup> downloaded = link::download_backup(server, download);
    progress.clear();
    if (!downloaded)
      return refuse(kCommand, downloaded.error(), err);
    if (options.json)
      out << json::download_to_json(download.file.string(), downloaded->bytes, downloaded->sha256)
          << '\n';
    else
      out << "'" << download.file.string() << "', " << downloaded->bytes << " bytes"
          << (downloaded->resumed > 0
                  ? ", " + std::to_string(downloaded->resumed) + " of them were here"
                  : "")
          << ", SHA-256 " << downloaded->sha256.hex() << '\n';
    return kDone;
  } catch (const Failure& failure) {
    progress.clear();
    return refuse(kCommand, failure.error(), err);
  }
}

}  // namespace kinship::cli
