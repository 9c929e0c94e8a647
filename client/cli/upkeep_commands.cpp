#include "client/cli/upkeep_commands.hpp"

#include <algorithm>
#include <ostream>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "client/link/robot_names.hpp"
#include "client/link/robot_upkeep.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/types/names.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kRetirePath = "paths retire", kResetTask = "tasks reset";
constexpr std::string_view kRestore = "paths restore", kRenameTask = "tasks rename",
                           kRemoveTask = "tasks remove";
constexpr const char* kNothingToRetire = "nothing to do: retired already\n";

int retire(link::Client& server, AdminVerb verb, const std::string& argument, bool json,
           std::ostream& out, std::ostream& err) {
  const std::string_view command = verb == AdminVerb::RetirePath ? kRetirePath : kResetTask;
  const auto retirement = link::row_of<Retirement>(server, {.verb = verb, .argument = argument});
  if (!retirement)
    return refuse(command, retirement.error(), err);
  if (json)
    out << json::to_document(*retirement) << '\n';
  else if (retirement->paths == 0)
    out << kNothingToRetire;
  else
    out << count_text(retirement->paths, "path") << " of task '" << retirement->task
        << "' retired, of " << count_text(retirement->robots.size(), "robot")
        << "; distributions made of them are not served any more\n";
  return kDone;
}

constexpr std::string_view kRename = "robots rename", kRemove = "robots remove";

int say_what_would_happen(link::Client& server, const RobotSummary& robot, std::ostream& err) {
  const auto distributions =
      link::rows_of(server, {.verb = AdminVerb::ListDistributions, .robot = robot.robot.hex()});
  if (!distributions)
    return refuse(kRemove, distributions.error(), err);
  if (robot.attempts == 0) {
    err << kRemove << ": this would delete '" << robot.label << "' (" << robot.robot.short_hex()
        << "), which has no attempts, and " << count_text(distributions->size(), "distribution")
        << " for it. To do it: kinship robots remove " << robot.label << " --yes\n";
    return kWrongUsage;
  }
  err << kRemove << ": this would retire " << count_text(robot.paths, "path") << " of '"
      << robot.label << "' (" << robot.robot.short_hex() << "): out of every fit. "
      << count_text(robot.attempts, "attempt") << " would stay on record, "
      << count_text(distributions->size(), "distribution")
      << " for it would go, those of other robots that used its paths be fitted anew. To do it: "
         "kinship robots remove "
      << robot.label << " --yes; to free the label alone: kinship robots rename " << robot.label
      << " NEW\n";
  return kWrongUsage;
}

void print_removal(const RobotRemoval& removal, std::ostream& out) {
  out << '\'' << removal.label << "' (" << removal.robot.short_hex() << ") ";
  if (removal.is_deleted)
    out << "deleted: it had no attempts";
  else
    out << "removed: " << count_text(removal.paths, "path") << " retired, "
        << count_text(removal.attempts, "attempt") << " stay on record";
  out << "; " << count_text(removal.distributions, "distribution")
      << " for it gone; the label is free\n"
      << "If its clients report again they register it again; while another robot has the label "
         "their reports wait with them\n";
}

}  // namespace

int retire_path(link::Client& server, const std::string& id, bool confirmed, bool json,
                std::ostream& out, std::ostream& err) {
  if (confirmed)
    return retire(server, AdminVerb::RetirePath, id, json, out, err);
  const Result<std::string> row =
      link::first_row_of(server, {.verb = AdminVerb::ShowPath, .argument = id});
  if (!row)
    return refuse(kRetirePath, row.error(), err);
  const auto named = json::stored_attempt_from_json(*row);
  if (!named)
    return refuse(kRetirePath, link::unreadable_row(named.error()), err);
  const Attempt& attempt = named->attempt;
  err << kRetirePath << ": this would retire the path of " << attempt.report_uuid.text()
      << ", task '" << attempt.task << "', robot " << attempt.robot.short_hex()
      << ": out of every fit, kept for the record; kinship paths restore brings it back. To do "
         "it: kinship paths retire "
      << id << " --yes\n";
  return kWrongUsage;
}

int restore_paths(link::Client& server, const RestoreOptions& options, std::ostream& out,
                  std::ostream& err) {
  const auto restored = link::row_of<Restoration>(server, {.verb = AdminVerb::RestorePath,
                                                           .argument = options.id,
                                                           .robot = options.robot,
                                                           .task = options.task});
  if (!restored)
    return refuse(kRestore, restored.error(), err);
  if (options.json) {
    out << json::to_document(*restored) << '\n';
  } else {
    out << count_text(restored->paths, "path")
        << (restored->task.empty() ? "" : " of task '" + restored->task + "'") << " restored";
    if (restored->paths > 0)
      out << ", under UUIDs of their own, the first " << restored->report_uuid.text();
    if (restored->in_use > 0)
      out << "; " << restored->in_use << " in use already";
    if (restored->lost > 0)
      out << "; " << restored->lost << " cannot be restored";
    if (!restored->reason.empty())
      out << " (" << restored->reason << ')';
    out << '\n';
  }
  if (restored->paths + restored->in_use + restored->lost == 0)
    return kNotFound;
  return restored->lost > 0 ? kFailed : kDone;
}

int rename_task(link::Client& server, const std::string& task, const std::string& name, bool json,
                std::ostream& out, std::ostream& err) {
  const auto summary = link::row_of<TaskSummary>(
      server, {.verb = AdminVerb::RenameTask, .argument = name, .task = task});
  if (!summary)
    return refuse(kRenameTask, summary.error(), err);
  if (json)
    out << json::to_document(*summary) << '\n';
  else
    out << "task '" << task << "' is called '" << summary->task << "' now, with "
        << count_text(summary->paths, "path") << "; its distributions are fitted anew\n"
        << "Robots that still report '" << task << "' begin a task of that name again\n";
  return kDone;
}

int remove_task(link::Client& server, const std::string& task, bool confirmed, bool json,
                std::ostream& out, std::ostream& err) {
  if (!confirmed) {
    const auto summary =
        link::row_of<TaskSummary>(server, {.verb = AdminVerb::ShowTask, .argument = task});
    if (!summary)
      return refuse(kRemoveTask, summary.error(), err);
    err << kRemoveTask << ": this would retire " << count_text(summary->paths, "path") << " of '"
        << task << "' and list it no more; " << count_text(summary->attempts, "attempt")
        << " would stay on record. To do it: kinship tasks remove " << task << " --yes\n";
    return kWrongUsage;
  }
  const auto removal =
      link::row_of<TaskRemoval>(server, {.verb = AdminVerb::RemoveTask, .argument = task});
  if (!removal)
    return refuse(kRemoveTask, removal.error(), err);
  if (json)
    out << json::to_document(*removal) << '\n';
  else
    out << "task '" << removal->task << "' removed: " << count_text(removal->paths, "path")
        << " retired, " << count_text(removal->attempts, "attempt") << " stay on record; "
        << count_text(removal->distributions, "distribution")
        << " gone. A new report of it lists it again\n";
  return kDone;
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
    out << (json ? json::to_document(Retirement{summary->task, 0, {}}) + "\n" : kNothingToRetire);
    return kDone;
  }
  const auto robots = std::ranges::count_if(
      summary->robots, [](const TaskRobotSummary& robot) { return robot.paths > 0; });
  err << kResetTask << ": this would retire " << count_text(summary->paths, "path") << " of "
      << count_text(static_cast<std::uint64_t>(robots), "robot")
      << ": out of every fit, kept for the record; kinship paths restore --task brings them back. "
         "To "
         "do it: kinship tasks reset "
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
    out << json::to_document(*evicted) << '\n';
  else
    out << "distribution " << evicted->id.short_hex()
        << " evicted; the next fetch has it made anew\n";
  return kDone;
}

int rename_robot(link::Client& server, const std::string& robot, const std::string& label,
                 bool json, std::ostream& out, std::ostream& err) {
  if (const auto error = check_label(label))
    return refuse(kRename, *error, err);
  const auto summary = link::rename_robot(server, robot, label);
  if (!summary)
    return refuse(kRename, summary.error(), err);
  if (json)
    out << json::to_document(*summary) << '\n';
  else
    out << "robot " << summary->robot.short_hex() << " is called '" << summary->label << "' now\n";
  return kDone;
}

int remove_robot(link::Client& server, const std::string& robot, bool confirmed, bool json,
                 std::ostream& out, std::ostream& err) {
  const auto summary = link::find_robot(server, robot);
  if (!summary)
    return refuse(kRemove, summary.error(), err);
  if (!confirmed)
    return say_what_would_happen(server, *summary, err);
  // By its digest: the label may be another robot's by now.
  const auto removal = link::remove_robot(server, summary->robot.hex());
  if (!removal)
    return refuse(kRemove, removal.error(), err);
  if (json)
    out << json::to_document(*removal) << '\n';
  else
    print_removal(*removal, out);
  return kDone;
}

}  // namespace kinship::cli
