#include "client/cli/retire_commands.hpp"

#include <algorithm>
#include <ostream>

#include "client/cli/admin_rows.hpp"
#include "client/cli/cell_text.hpp"
#include "client/link/admin_rows.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kRetirePath = "paths retire", kResetTask = "tasks reset";
constexpr const char* kNothingToRetire = "nothing to do: retired already\n";

int retire(link::Client& server, AdminVerb verb, const std::string& argument, bool json,
           std::ostream& out, std::ostream& err) {
  const std::string_view command = verb == AdminVerb::RetirePath ? kRetirePath : kResetTask;
  const auto retirement = link::row_of<Retirement>(server, {.verb = verb, .argument = argument});
  if (!retirement)
    return refuse(command, retirement.error(), err);
  if (json)
    out << json::to_json(*retirement) << '\n';
  else if (retirement->paths == 0)
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
  const auto summary =
      link::row_of<TaskSummary>(server, {.verb = AdminVerb::ShowTask, .argument = task});
  if (!summary)
    return refuse(kResetTask, summary.error(), err);
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
  const auto evicted =
      link::row_of<Eviction>(server, {.verb = AdminVerb::EvictDistribution, .argument = id});
  if (!evicted)
    return refuse(kCommand, evicted.error(), err);
  if (json)
    out << json::to_json(*evicted) << '\n';
  else
    out << "distribution " << evicted->id.short_hex()
        << " evicted; the next fetch has it made anew\n";
  return kDone;
}

}  // namespace kinship::cli
