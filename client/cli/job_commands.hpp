#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

#include "client/cli/admin_rows.hpp"
#include "client/link/client.hpp"
#include "proto/types/summaries.hpp"

/// Commands about what takes the server long.
namespace kinship::cli {

/// How a job is waited for.
struct WaitOptions {
  std::chrono::milliseconds longest{std::chrono::hours(24)};
  bool progress = false;  ///< how far it is is told on `err`
};

/// `jobs wait`. \return kDone if it was done, kFailed if it failed, was cancelled or goes on.
int wait_for_job(link::Client& server, const std::string& id, const WaitOptions& options, bool json,
                 std::ostream& out, std::ostream& err);

int cancel_job(link::Client& server, const std::string& id, bool json, std::ostream& out,
               std::ostream& err);

/// Begins a job and waits for its end.
/// \param done  what it was for, once it is done. \return an exit code.
int run_job(link::Client& server, const AdminRequest& begin, const WaitOptions& options,
            std::string_view command, std::ostream& err,
            const std::function<int(const Job&)>& done);

struct BackupOptions {
  std::filesystem::path file;  ///< at the server; a relative one is taken from the folder here
  bool wait = true;
  WaitOptions waiting;
  bool json = false;
};

/// Why a server on `host` cannot be asked for a file: it would be completed with the folder here,
/// but is written there; empty if it can.
std::string why_unusable(const std::filesystem::path& file, const std::string& host);

/// `backup`: copies the store of a running server into a new file.
int back_up(link::Client& server, const BackupOptions& options, std::ostream& out,
            std::ostream& err);

}  // namespace kinship::cli
