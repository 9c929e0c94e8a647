#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "client/link/client.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"

/// A backup of the server as a file here.
namespace kinship::link {

struct BackupDownload {
  std::string name;            ///< in the server's folder of backups
  std::filesystem::path file;  ///< here; must not be there yet
  /// How long it goes on asking a server that does not answer, as while it is started again.
  std::chrono::milliseconds patience{std::chrono::seconds(60)};
  /// How many bytes are here, of how many; 0: nobody knows yet. May be empty.
  std::function<void(std::uint64_t here, std::uint64_t of)> on_progress = {};
};

struct DownloadedBackup {
  std::uint64_t bytes = 0;
  std::uint64_t resumed = 0;  ///< of them were here before
  Digest sha256;
};

/// Fetches a backup piece by piece into FILE.part, goes on where an earlier download ended, and
/// gives it its name once its digest is the one that the server found.
/// \return NotFound; Conflict if the file is there, or another process fetches it; Unavailable if
///         the server did not answer for so long: what is here stays for the next time; Internal if
///         what came is not what the server has: it is removed.
/// \throws Failure(Storage) if the file cannot be written.
Result<DownloadedBackup> download_backup(Client& server, const BackupDownload& download);

}  // namespace kinship::link
