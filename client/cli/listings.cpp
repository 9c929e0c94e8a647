#include "client/cli/listings.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/summaries_json.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;
using tables::Table;

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

/// Labels of robots by their digests, asked for when the first is wanted.
class RobotLabels {
 public:
  explicit RobotLabels(link::Client& server) : server_(&server) {}

  /// The short digest of a robot that the server does not list.
  std::string of(const Digest& robot) {
    if (!labels_)
      read();
    const auto known = labels_->find(robot);
    return known == labels_->end() ? robot.short_hex() : known->second;
  }

 private:
  void read() {
    labels_.emplace();
    AdminRequest request;
    request.verb = AdminVerb::ListRobots;
    // Without an answer digests do.
    static_cast<void>(link::for_each_row(*server_, request, [this](const std::string& row) {
      if (const auto robot = json::robot_summary_from_json(row))
        labels_->emplace(robot->robot, robot->label);
      return true;
    }));
  }

  link::Client* server_;
  std::optional<std::map<Digest, std::string>> labels_;
};

/// Profile and selection: "default, by sources, only panda iiwa14, since 2026-11-21T05:32:00Z".
std::string made_of_text(const DistributionSummary& distribution, RobotLabels& labels) {
  const Selection& selection = distribution.selection;
  std::string text = distribution.profile;
  if (selection.weighting)
    text += ", by " + std::string(to_text(*selection.weighting));
  if (!selection.sources.empty())
    text += ", only";
  for (const Digest& robot : selection.sources)
    text += " " + labels.of(robot);
  if (selection.since_ms > 0)
    text += ", since " + time_text(selection.since_ms);
  return text;
}

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

std::vector<std::string> path_cells(const PathSummary& path, std::int64_t now_ms) {
  const std::string state = path.dropped ? "dropped" : "retired";
  return {path.report_uuid.text(),
          path.label,
          path.task,
          std::to_string(path.record.collision_checks),
          age_text(path.received_ms, now_ms),
          path.retired_ms == 0 ? "-" : state,
          std::to_string(path.waypoints),
          number_text(path.length, 2),
          number_text(path.record.planning_time_s, 3),
          path.record.planner,
          std::string(to_text(path.record.sampling_mode)),
          path.machine,
          time_text(path.received_ms),
          path.retired_ms == 0 ? "-" : time_text(path.retired_ms)};
}

std::vector<std::string> distribution_cells(const DistributionSummary& distribution,
                                            std::int64_t now_ms, RobotLabels& labels) {
  return {distribution.id.short_hex(),
          distribution.label,
          distribution.task,
          distribution.retired ? "retired" : std::string(to_text(distribution.state)),
          age_text(distribution.fitted_ms, now_ms),
          distribution.T_task_base ? short_pose_text(*distribution.T_task_base) : "-",
          made_of_text(distribution, labels),
          std::to_string(distribution.revision),
          std::to_string(distribution.components),
          std::to_string(distribution.configurations),
          std::to_string(distribution.paths),
          time_text(distribution.fitted_ms)};
}

}  // namespace

int list_robots(link::Client& server, const ListOptions& options, std::ostream& out,
                std::ostream& err) {
  return list_rows(server,
                   Listing{AdminVerb::ListRobots, "robots list",
                           Table({"ROBOT",
                                  {"LABEL", Fit::Cut},
                                  "DOF",
                                  {"CHAIN", Fit::Cut},
                                  "PATHS",
                                  "ATTEMPTS",
                                  "AGE",
                                  {"REGISTERED", Fit::Wide}}),
                           json::robot_summary_from_json,
                           [now = now_ms()](const RobotSummary& robot) {
                             return std::vector<std::string>{
                                 robot.robot.short_hex(),
                                 robot.label,
                                 std::to_string(robot.dof),
                                 robot.base_link + " -> " + robot.tip_link,
                                 std::to_string(robot.paths),
                                 std::to_string(robot.attempts),
                                 age_text(robot.registered_ms, now),
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
  return list_rows(
      server,
      Listing{AdminVerb::ListPaths, "paths list",
              Table({"PATH",
                     {"ROBOT", Fit::Cut},
                     {"TASK", Fit::Cut},
                     "CHECKS",
                     "AGE",
                     "STATE",
                     {"WAYPOINTS", Fit::Wide},
                     {"LENGTH", Fit::Wide},
                     {"TIME_S", Fit::Wide},
                     {"PLANNER", Fit::Wide},
                     {"ARM", Fit::Wide},
                     {"MACHINE", Fit::Wide},
                     {"RECEIVED", Fit::Wide},
                     {"RETIRED", Fit::Wide}}),
              json::path_summary_from_json,
              [now = now_ms()](const PathSummary& path) { return path_cells(path, now); }},
      options, out, err);
}

int list_distributions(link::Client& server, const ListOptions& options, std::ostream& out,
                       std::ostream& err) {
  return list_rows(server,
                   Listing{AdminVerb::ListDistributions, "distributions list",
                           Table({"DISTRIBUTION",
                                  {"ROBOT", Fit::Cut},
                                  {"TASK", Fit::Cut},
                                  "STATE",
                                  "AGE",
                                  "PLACEMENT",
                                  "MADE OF",
                                  {"REVISION", Fit::Wide},
                                  {"K", Fit::Wide},
                                  {"CONFIGURATIONS", Fit::Wide},
                                  {"PATHS", Fit::Wide},
                                  {"FITTED", Fit::Wide}}),
                           json::distribution_summary_from_json,
                           [now = now_ms(), labels = RobotLabels(server)](
                               const DistributionSummary& distribution) mutable {
                             return distribution_cells(distribution, now, labels);
                           }},
                   options, out, err);
}

int list_jobs(link::Client& server, const ListOptions& options, std::ostream& out,
              std::ostream& err) {
  return list_rows(server,
                   Listing{AdminVerb::ListJobs, "jobs list",
                           Table({"JOB",
                                  "VERB",
                                  "STATE",
                                  "PROGRESS",
                                  "AGE",
                                  "ARGUMENT",
                                  "MESSAGE",
                                  {"ROWS", Fit::Wide},
                                  {"STARTED", Fit::Wide}}),
                           json::job_from_json,
                           [now = now_ms()](const Job& job) {
                             return std::vector<std::string>{
                                 job.id,
                                 job.verb,
                                 std::string(to_text(job.state)),
                                 percent_text(job.progress),
                                 age_text(job.started_ms, now),
                                 job.argument,
                                 job.message,
                                 std::to_string(job.rows),
                                 job.started_ms == 0 ? "-" : time_text(job.started_ms)};
                           }},
                   options, out, err);
}

}  // namespace kinship::cli
