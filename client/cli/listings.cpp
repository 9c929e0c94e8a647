#include "client/cli/listings.hpp"

#include <functional>
#include <ostream>
#include <vector>

#include "client/cli/table.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/summaries_json.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::cli {
namespace {

/// What a list verb answers, and how it is shown.
template <typename Parse, typename Cells>
struct Listing {
  AdminVerb verb;
  std::string command;  ///< named in messages
  Table table;          ///< its headings
  Parse parse;          ///< row text -> Result<Row>
  Cells cells;          ///< Row -> one cell per heading
};
template <typename Parse, typename Cells>
Listing(AdminVerb, const char*, Table, Parse, Cells) -> Listing<Parse, Cells>;

/// Lists rows in a table, or as JSON.
template <typename Parse, typename Cells>
int list_rows(link::Client& server, Listing<Parse, Cells> listing, const ListOptions& options,
              std::ostream& out, std::ostream& err) {
  const std::string& command = listing.command;
  if (options.json)
    return print_rows_as_json(server, listing.verb, options, command, out, err);
  bool readable = true;
  const int code =
      for_each_row(server, listing.verb, options, command, err, [&](const std::string& text) {
        const auto row = listing.parse(text);
        readable = row.has_value();
        if (readable)
          listing.table.add_row(listing.cells(*row));
        else
          err << command << ": cannot read the server's row: " << row.error().message << '\n';
        return readable;
      });
  if (code != kDone)
    return code;
  if (!readable)
    return kFailed;
  listing.table.print(out);
  return kDone;
}

}  // namespace

int list_robots(link::Client& server, const ListOptions& options, std::ostream& out,
                std::ostream& err) {
  return list_rows(
      server,
      Listing{AdminVerb::ListRobots, "robots list",
              Table({"ROBOT", "LABEL", "DOF", "CHAIN", "PATHS", "ATTEMPTS", "REGISTERED"}),
              json::robot_summary_from_json,
              [](const RobotSummary& robot) {
                return std::vector<std::string>{
                    robot.robot.short_hex(),       robot.label,
                    std::to_string(robot.dof),     robot.base_link + " -> " + robot.tip_link,
                    std::to_string(robot.paths),   std::to_string(robot.attempts),
                    time_text(robot.registered_ms)};
              }},
      options, out, err);
}

int list_tasks(link::Client& server, const ListOptions& options, std::ostream& out,
               std::ostream& err) {
  return list_rows(
      server,
      Listing{AdminVerb::ListTasks, "tasks list", Table({"TASK", "ROBOTS", "PATHS", "ATTEMPTS"}),
              json::task_summary_from_json,
              [](const TaskSummary& task) {
                return std::vector<std::string>{task.task, std::to_string(task.robots.size()),
                                                kept_text(task.paths, task.dropped),
                                                std::to_string(task.attempts)};
              }},
      options, out, err);
}

int list_paths(link::Client& server, const ListOptions& options, std::ostream& out,
               std::ostream& err) {
  return list_rows(server,
                   Listing{AdminVerb::ListPaths, "paths list",
                           Table({"PATH", "ROBOT", "TASK", "WAYPOINTS", "LENGTH", "CHECKS",
                                  "TIME_S", "PLANNER", "ARM", "MACHINE", "RECEIVED", "RETIRED"}),
                           json::path_summary_from_json,
                           [](const PathSummary& path) {
                             return std::vector<std::string>{
                                 path.report_uuid.text(),
                                 path.label,
                                 path.task,
                                 std::to_string(path.waypoints),
                                 number_text(path.length, 2),
                                 std::to_string(path.record.collision_checks),
                                 number_text(path.record.planning_time_s, 3),
                                 path.record.planner,
                                 std::string(to_text(path.record.sampling_mode)),
                                 path.machine,
                                 time_text(path.received_ms),
                                 path.retired_ms == 0 ? "-"
                                                      : (path.dropped ? "dropped " : "") +
                                                            time_text(path.retired_ms)};
                           }},
                   options, out, err);
}

int list_distributions(link::Client& server, const ListOptions& options, std::ostream& out,
                       std::ostream& err) {
  return list_rows(
      server,
      Listing{AdminVerb::ListDistributions, "distributions list",
              Table({"DISTRIBUTION", "REVISION", "TASK", "ROBOT", "PROFILE", "STATE", "K",
                     "CONFIGURATIONS", "PATHS", "FITTED"}),
              json::distribution_summary_from_json,
              [](const DistributionSummary& distribution) {
                return std::vector<std::string>{
                    distribution.id.short_hex(),
                    std::to_string(distribution.revision),
                    distribution.task,
                    distribution.label,
                    distribution.profile,
                    distribution.retired ? "retired" : std::string(to_text(distribution.state)),
                    std::to_string(distribution.components),
                    std::to_string(distribution.configurations),
                    std::to_string(distribution.paths),
                    time_text(distribution.fitted_ms)};
              }},
      options, out, err);
}

int list_jobs(link::Client& server, const ListOptions& options, std::ostream& out,
              std::ostream& err) {
  return list_rows(
      server,
      Listing{AdminVerb::ListJobs, "jobs list",
              Table({"JOB", "VERB", "ARGUMENT", "STATE", "PROGRESS", "ROWS", "STARTED", "MESSAGE"}),
              json::job_from_json,
              [](const Job& job) {
                return std::vector<std::string>{
                    job.id,
                    job.verb,
                    job.argument,
                    std::string(to_text(job.state)),
                    percent_text(job.progress),
                    std::to_string(job.rows),
                    job.started_ms == 0 ? "-" : time_text(job.started_ms),
                    job.message};
              }},
      options, out, err);
}

}  // namespace kinship::cli
