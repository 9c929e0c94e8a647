#include "client/cli/listings.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;
using tables::Table;

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
      if (const auto robot = json::row_from_json<RobotSummary>(row))
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

std::string labels_text(const std::vector<std::string>& labels) {
  std::string text;
  for (const std::string& label : labels)
    text += (text.empty() ? "" : ", ") + label;
  return text.empty() ? "-" : text;
}

/// "12, last for bytes".
std::string refused_text(const ClientUse& client) {
  const std::string count = std::to_string(client.refused);
  return client.refused_for.empty() ? count : count + ", last for " + client.refused_for;
}

std::vector<std::string> client_cells(const ClientUse& client, std::int64_t now) {
  return {client.client,
          labels_text(client.robots),
          number_text(client.attempts_per_s, 1),
          size_text(static_cast<std::uint64_t>(client.bytes_per_s)),
          std::to_string(client.on_way + client.waiting),
          std::to_string(client.leases),
          std::to_string(client.fits),
          refused_text(client),
          age_text(client.last_seen_ms, now),
          std::to_string(client.attempts),
          std::to_string(client.registered_robots),
          std::to_string(client.created_tasks),
          size_text(client.stored_bytes)};
}

}  // namespace

int list_robots(link::Client& server, const ListOptions& options, std::ostream& out,
                std::ostream& err) {
  return list_rows(server,
                   Listing<RobotSummary>{AdminVerb::ListRobots, "robots list",
                                         Table({"ROBOT",
                                                {"LABEL", Fit::Cut},
                                                "DOF",
                                                {"CHAIN", Fit::Cut},
                                                "PATHS",
                                                "ATTEMPTS",
                                                "AGE",
                                                {"REGISTERED", Fit::Wide}}),
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
  return list_rows(server,
                   Listing<TaskSummary>{AdminVerb::ListTasks, "tasks list",
                                        Table({"TASK", "ROBOTS", "PATHS", "ATTEMPTS"}),
                                        [](const TaskSummary& task) {
                                          return std::vector<std::string>{
                                              task.task, std::to_string(task.robots.size()),
                                              kept_text(task.paths, task.dropped),
                                              std::to_string(task.attempts)};
                                        }},
                   options, out, err);
}

int list_paths(link::Client& server, const ListOptions& options, std::ostream& out,
               std::ostream& err) {
  return list_rows(server,
                   Listing<PathSummary>{
                       AdminVerb::ListPaths, "paths list",
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
                              {"MODE", Fit::Wide},
                              {"MACHINE", Fit::Wide},
                              {"RECEIVED", Fit::Wide},
                              {"RETIRED", Fit::Wide}}),
                       [now = now_ms()](const PathSummary& path) { return path_cells(path, now); }},
                   options, out, err);
}

int list_distributions(link::Client& server, const ListOptions& options, std::ostream& out,
                       std::ostream& err) {
  return list_rows(
      server,
      Listing<DistributionSummary>{AdminVerb::ListDistributions, "distributions list",
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
                                   [now = now_ms(), labels = RobotLabels(server)](
                                       const DistributionSummary& distribution) mutable {
                                     return distribution_cells(distribution, now, labels);
                                   }},
      options, out, err);
}

int list_jobs(link::Client& server, const ListOptions& options, std::ostream& out,
              std::ostream& err) {
  return list_rows(server,
                   Listing<Job>{AdminVerb::ListJobs, "jobs list",
                                Table({"JOB",
                                       "VERB",
                                       "STATE",
                                       "PROGRESS",
                                       "AGE",
                                       "ARGUMENT",
                                       "MESSAGE",
                                       {"ROWS", Fit::Wide},
                                       {"STARTED", Fit::Wide}}),
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

int list_clients(link::Client& server, const ListOptions& options, std::ostream& out,
                 std::ostream& err) {
  return list_rows(server,
                   Listing<ClientUse>{AdminVerb::ListClients, "status --clients",
                                      Table({"CLIENT",
                                             {"ROBOTS", Fit::Cut},
                                             "ATTEMPTS/S",
                                             "BYTES/S",
                                             "WAITING",
                                             "LEASES",
                                             "FITS",
                                             "REFUSED",
                                             "SEEN",
                                             {"ATTEMPTS", Fit::Wide},
                                             {"NEW ROBOTS", Fit::Wide},
                                             {"NEW TASKS", Fit::Wide},
                                             {"STORED", Fit::Wide}}),
                                      [now = now_ms()](const ClientUse& client) {
                                        return client_cells(client, now);
                                      }},
                   options, out, err);
}

int list_backups(link::Client& server, const ListOptions& options, std::ostream& out,
                 std::ostream& err) {
  return list_rows(server,
                   Listing<BackupSummary>{AdminVerb::ListBackups, "backup list",
                                          Table({"NAME", "SIZE", "AGE", {"WRITTEN", Fit::Wide}}),
                                          [now = now_ms()](const BackupSummary& backup) {
                                            return std::vector<std::string>{
                                                backup.name, size_text(backup.bytes),
                                                age_text(backup.modified_ms, now),
                                                time_text(backup.modified_ms)};
                                          }},
                   options, out, err);
}

}  // namespace kinship::cli
