#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

#include "client/cli/terminal.hpp"
#include "client/link/client.hpp"
#include "proto/types/summaries.hpp"

/// Commands about the server's jobs.
namespace kinship::cli {

/// Options of a wait for a job.
struct WaitOptions {
  std::chrono::milliseconds longest{std::chrono::hours(24)};
  bool progress = false;  ///< shows progress on `err`
};

/// `jobs wait`. \return kDone if the job is done, kFailed if it failed, was cancelled or goes on.
int wait_for_job(link::Client& server, const std::string& id, const WaitOptions& options, bool json,
                 std::ostream& out, std::ostream& err);

int cancel_job(link::Client& server, const std::string& id, bool json, std::ostream& out,
               std::ostream& err);

/// A job's state, as a line or a document.
void print(const Job& job, bool json, std::ostream& out);

/// Begins a job and waits for its end.
/// \param done  called with the finished job. \return an exit code.
int run_job(link::Client& server, const AdminRequest& begin, const WaitOptions& options,
            std::string_view command, std::ostream& err,
            const std::function<int(const Job&)>& done);

}  // namespace kinship::cli
