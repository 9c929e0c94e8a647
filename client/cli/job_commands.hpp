#pragma once

#include <chrono>
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

/// A job as it stands, in a line or as a document.
void print(const Job& job, bool json, std::ostream& out);

/// Begins a job and waits for its end.
/// \param done  what it was for, once it is done. \return an exit code.
int run_job(link::Client& server, const AdminRequest& begin, const WaitOptions& options,
            std::string_view command, std::ostream& err,
            const std::function<int(const Job&)>& done);

}  // namespace kinship::cli
