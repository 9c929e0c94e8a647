#include "client/cli/job_commands.hpp"

#include <optional>
#include <ostream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::cli {
namespace {

std::string said(const Job& job) { return job.message.empty() ? "" : ": " + job.message; }

/// Waits for a job's end. \return empty with an exit code in `code` if that cannot be known.
std::optional<Job> wait(link::Client& server, const std::string& id, const WaitOptions& options,
                        std::string_view command, std::ostream& err, int& code) {
  StatusLine progress(err, options.progress);
  const auto show = [&](const Job& job) {
    progress.show(job.verb + " " + percent_text(job.progress));
  };
  const Result<Job> job =
      link::wait_for_job(server, id, std::chrono::steady_clock::now() + options.longest, show);
  progress.clear();
  if (!job) {
    code = refuse(command, job.error(), err);
    return std::nullopt;
  }
  return *job;
}

int code_of(const Job& job, std::string_view command, std::ostream& err) {
  if (job.state == JobState::Done)
    return kDone;
  if (link::has_ended(job))
    err << command << ": job " << job.id << " " << to_text(job.state) << said(job) << '\n';
  else
    err << command << ": job " << job.id << " goes on (see: kinship jobs wait " << job.id << ")\n";
  return kFailed;
}

}  // namespace

void print(const Job& job, bool json, std::ostream& out) {
  if (json)
    out << json::to_document(job) << '\n';
  else
    out << "job " << job.id << ", " << job.verb << (job.argument.empty() ? "" : " ") << job.argument
        << ": " << to_text(job.state) << said(job) << '\n';
}

int wait_for_job(link::Client& server, const std::string& id, const WaitOptions& options, bool json,
                 std::ostream& out, std::ostream& err) {
  constexpr const char* kCommand = "jobs wait";
  int code = kDone;
  const auto job = wait(server, id, options, kCommand, err, code);
  if (!job)
    return code;
  if (json || job->state == JobState::Done)
    print(*job, json, out);
  return code_of(*job, kCommand, err);
}

int cancel_job(link::Client& server, const std::string& id, bool json, std::ostream& out,
               std::ostream& err) {
  const Result<Job> job = link::row_of<Job>(server, {.verb = AdminVerb::CancelJob, .argument = id});
  if (!job)
    return refuse("jobs cancel", job.error(), err);
  if (job->state == JobState::Done || job->state == JobState::Failed)
    err << "jobs cancel: nothing to cancel, job " << job->id << " has ended\n";
  print(*job, json, out);
  return kDone;
}

int run_job(link::Client& server, const AdminRequest& begin, const WaitOptions& options,
            std::string_view command, std::ostream& err,
            const std::function<int(const Job&)>& done) {
  const Result<Job> begun = link::row_of<Job>(server, begin);
  if (!begun)
    return refuse(command, begun.error(), err);
  int code = kDone;
  const auto job = wait(server, begun->id, options, command, err, code);
  if (!job)
    return code;
  code = code_of(*job, command, err);
  return code == kDone ? done(*job) : code;
}

}  // namespace kinship::cli
