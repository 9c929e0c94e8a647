#include "client/cli/retire_commands.hpp"

#include <algorithm>
#include <ostream>

#include "client/cli/admin_rows.hpp"
#include "client/cli/cell_text.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/summaries_json.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kRetirePath = "paths retire", kResetTask = "tasks reset";
constexpr const char* kNothingToRetire = "nothing to do: retired already\n";

int retire(link::Client& server, AdminVerb verb, const std::string& argument, bool json,
           std::ostream& out, std::ostream& err) {
  const std::string_view command = verb == AdminVerb::RetirePath ? kRetirePath : kResetTask;
  int code = kDone;
  const auto rows = show_rows(server, verb, argument, command, err, code);
  if (code != kDone)
    return code;
  if (json) {
    out << rows.front() << '\n';
    return kDone;
  }
  const auto retirement = json::retirement_from_json(rows.front());
  if (!retirement)
    return refuse(command, {ErrorCode::Internal, retirement.error().message}, err);
  if (retirement->paths == 0)
    out << kNothingToRetire;
  else
    out << count_text(retirement->paths, "path") << " of task '" << retirement->task
        << "' retired, of " << count_text(retirement->robots.size(), "robot")
        << "; distributions made of them are not served any more\n";
  return kDone;
}

}  // namespace

int retire_path(link::Client& server, const std::string& id, bool json, std::ostream& out,
                std::ostream& err) {
  return retire(server, AdminVerb::RetirePath, id, json, out, err);
}

int reset_task(link::Client& server, const std::string& task, bool confirmed, bool json,
               std::ostream& out, std::ostream& err) {
  if (confirmed)
    return retire(server, AdminVerb::ResetTask, task, json, out, err);
  int code = kDone;
  const auto rows = show_rows(server, AdminVerb::ShowTask, task, kResetTask, err, code);
  if (code != kDone)
    return code;
  const auto summary = json::task_summary_from_json(rows.front());
  if (!summary)
    return refuse(kResetTask, {ErrorCode::Internal, summary.error().message}, err);
  if (summary->paths == 0) {
    out << (json ? json::to_json(Retirement{summary->task, 0, {}}) + "\n" : kNothingToRetire);
    return kDone;
  }
  const auto robots = std::ranges::count_if(
      summary->robots, [](const TaskRobotSummary& robot) { return robot.paths > 0; });
  err << kResetTask << ": this would retire " << count_text(summary->paths, "path") << " of "
      << count_text(static_cast<std::uint64_t>(robots), "robot")
      << ": out of every fit, kept for the record, not to be undone. To do it: kinship tasks reset "
      << task << " --yes\n";
  return kWrongUsage;
}

int evict_distribution(link::Client& server, const std::string& id, bool json, std::ostream& out,
                       std::ostream& err) {
  constexpr const char* kCommand = "distributions evict";
  int code = kDone;
  const auto rows = show_rows(server, AdminVerb::EvictDistribution, id, kCommand, err, code);
  if (code != kDone)
    return code;
  const auto evicted = json::eviction_from_json(rows.front());
  if (!evicted)
    return refuse(kCommand, {ErrorCode::Internal, evicted.error().message}, err);
  if (json)
    out << rows.front() << '\n';
  else
    out << "distribution " << evicted->short_hex() << " evicted; the next fetch has it made anew\n";
  return kDone;
}

}  // namespace kinship::cli
