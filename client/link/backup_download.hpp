#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "client/link/client.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"

/// Download of a server's backup into a local file.
namespace kinship::link {

struct BackupDownload {
  std::string name;            ///< in the server's folder of backups
  std::filesystem::path file;  ///< local; must not exist yet
  /// How long the download retries a server that does not answer, as during a restart.
  std::chrono::milliseconds patience{std::chrono::seconds(60)};
  /// Receives the bytes downloaded and their total; total 0: not known yet. May be empty.
  std::function<void(std::uint64_t here, std::uint64_t of)> on_progress = {};
};

struct DownloadedBackup {
  std::uint64_t bytes = 0;
  std::uint64_t resumed = 0;  ///< of them, by an earlier download
  Digest sha256;
};

/// Fetches a backup piece by piece into FILE.part, resumes where an earlier download ended, and
/// renames the file once its digest equals the server's.
/// \return NotFound; Conflict if the file exists or another process downloads it; Unavailable if
///         the server did not answer within `patience`: FILE.part stays for the next attempt;
///         Internal if the digests differ: FILE.part is removed.
/// \throws Failure(Storage) if the file cannot be written.
Result<DownloadedBackup> download_backup(Client& server, const BackupDownload& download);

}  // namespace kinship::link
