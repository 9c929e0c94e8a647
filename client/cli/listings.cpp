#include "client/cli/listings.hpp"

#include <functional>
#include <ostream>
#include <vector>

#include "client/cli/exit_code.hpp"
#include "client/cli/table.hpp"
#include "proto/json/summaries_json.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::cli {
namespace {

/// Lists rows in a table, or as JSON.
/// \param parse  row text -> Result<Row>.
/// \param cells  Row -> one cell per heading.
template <typename Parse, typename Cells>
int list_rows(link::Client& server, AdminVerb verb, const ListOptions& options,
              const std::string& command, std::ostream& out, std::ostream& err, Table table,
              Parse parse, Cells cells) {
  if (options.json)
    return print_rows_as_json(server, verb, options, command, out, err);
  bool readable = true;
  const int code = for_each_row(server, verb, options, command, err, [&](const std::string& text) {
    const auto row = parse(text);
    readable = row.has_value();
    if (readable)
      table.add_row(cells(*row));
    else
      err << command << ": cannot read the server's row: " << row.error().message << '\n';
    return readable;
  });
  if (code != kDone)
    return code;
  if (!readable)
    return kFailed;
  table.print(out);
  return kDone;
}

}  // namespace

int list_robots(link::Client& server, const ListOptions& options, std::ostream& out,
                std::ostream& err) {
  return list_rows(server, AdminVerb::ListRobots, options, "robots list", out, err,
                   Table({"ROBOT", "LABEL", "DOF", "CHAIN", "PATHS", "ATTEMPTS", "REGISTERED"}),
                   json::robot_summary_from_json, [](const RobotSummary& robot) {
                     return std::vector<std::string>{
                         robot.robot.short_hex(),       robot.label,
                         std::to_string(robot.dof),     robot.base_link + " -> " + robot.tip_link,
                         std::to_string(robot.paths),   std::to_string(robot.attempts),
                         time_text(robot.registered_ms)};
                   });
}

int list_tasks(link::Client& server, const ListOptions& options, std::ostream& out,
               std::ostream& err) {
  return list_rows(server, AdminVerb::ListTasks, options, "tasks list", out, err,
                   Table({"TASK", "ROBOTS", "PATHS", "ATTEMPTS"}), json::task_summary_from_json,
                   [](const TaskSummary& task) {
                     return std::vector<std::string>{task.task, std::to_string(task.robots.size()),
                                                     std::to_string(task.paths),
                                                     std::to_string(task.attempts)};
                   });
}

int list_paths(link::Client& server, const ListOptions& options, std::ostream& out,
               std::ostream& err) {
  return list_rows(server, AdminVerb::ListPaths, options, "paths list", out, err,
                   Table({"PATH", "ROBOT", "TASK", "WAYPOINTS", "LENGTH", "CHECKS", "TIME_S",
                          "PLANNER", "ARM", "MACHINE", "RECEIVED", "RETIRED"}),
                   json::path_summary_from_json, [](const PathSummary& path) {
                     return std::vector<std::string>{
                         path.report_uuid.text(),
                         path.label,
                         path.task,
                         std::to_string(path.waypoints),
                         number_text(path.length, 2),
                         std::to_string(path.record.collision_checks),
                         number_text(path.record.planning_time_s, 3),
                         path.record.planner,
                         std::string(to_text(path.record.arm)),
                         path.machine,
                         time_text(path.received_ms),
                         path.retired_ms == 0 ? "-" : time_text(path.retired_ms)};
                   });
}

int list_distributions(link::Client& server, const ListOptions& options, std::ostream& out,
                       std::ostream& err) {
  return list_rows(server, AdminVerb::ListDistributions, options, "distributions list", out, err,
                   Table({"DISTRIBUTION", "REVISION", "TASK", "ROBOT", "PROFILE", "STATE", "K",
                          "CONFIGURATIONS", "PATHS", "FITTED"}),
                   json::distribution_summary_from_json,
                   [](const DistributionSummary& distribution) {
                     return std::vector<std::string>{distribution.id.short_hex(),
                                                     std::to_string(distribution.revision),
                                                     distribution.task,
                                                     distribution.label,
                                                     distribution.profile,
                                                     std::string(to_text(distribution.state)),
                                                     std::to_string(distribution.components),
                                                     std::to_string(distribution.configurations),
                                                     std::to_string(distribution.paths),
                                                     time_text(distribution.fitted_ms)};
                   });
}

}  // namespace kinship::cli
