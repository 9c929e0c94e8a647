#pragma once

#include <chrono>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/cli/job_commands.hpp"
#include "client/link/client.hpp"

/// Commands about copies of the store of a running server.
namespace kinship::cli {

struct BackupOptions {
  std::string name;  ///< bare: a file in the server's folder of backups
  bool wait = true;
  WaitOptions waiting;
  bool json = false;
};

/// `backup`: copies the store into a new file at the server.
int back_up(link::Client& server, const BackupOptions& options, std::ostream& out,
            std::ostream& err);

struct DownloadOptions {
  std::string name;
  std::filesystem::path to;  ///< local; empty: `name` in the current folder
  std::chrono::milliseconds patience{std::chrono::seconds(60)};
  bool progress = false;
  bool json = false;
};

/// `backup download`: copies a backup into a local file.
int download_backup(link::Client& server, const DownloadOptions& options, std::ostream& out,
                    std::ostream& err);

}  // namespace kinship::cli
