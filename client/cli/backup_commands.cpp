#include "client/cli/backup_commands.hpp"

#include <cstdint>
#include <ostream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "client/link/backup_download.hpp"
#include "proto/json/admin_rows_json.hpp"

namespace kinship::cli {

int back_up(link::Client& server, const BackupOptions& options, std::ostream& out,
            std::ostream& err) {
  constexpr const char* kCommand = "backup";
  const AdminRequest request{.verb = AdminVerb::Backup, .argument = options.name};
  if (options.wait)
    return run_job(server, request, options.waiting, kCommand, err, [&](const Job& job) {
      print(job, options.json, out);
      return kDone;
    });
  const Result<Job> job = link::row_of<Job>(server, request);
  if (!job)
    return refuse(kCommand, job.error(), err);
  print(*job, options.json, out);
  return kDone;
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
