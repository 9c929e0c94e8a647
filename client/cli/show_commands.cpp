#include "client/cli/show_commands.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <ostream>
#include <string_view>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/distribution_commands.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/value_text.hpp"
#include "client/link/admin_rows.hpp"
#include "client/link/robot_names.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/json/task_experience_json.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/duration_text.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;
using tables::Table;

/// A command that shows one object, and its request.
struct Question {
  std::string command;  ///< named in messages
  AdminRequest request;
  bool json = false;    ///< the answer's document as it came
  json::Format format;  ///< of that
};

/// Asks for one thing and prints it: its document as it came, or through `print`.
/// \param parse  row text -> Result<Value>.
/// \param print  Value -> nothing; writes to `out`.
template <typename Parse, typename Print>
int show(link::Client& server, const Question& question, std::ostream& out, std::ostream& err,
         Parse parse, Print print) {
  const Result<std::string> row = link::first_row_of(server, question.request);
  if (!row)
    return refuse(question.command, row.error(), err);
  if (question.json) {
    out << json::in_format(question.format, *row) << '\n';
    return kDone;
  }
  const auto value = parse(*row);
  if (!value)
    return refuse(question.command, link::unreadable_row(value.error()), err);
  print(*value);
  return kDone;
}

void print_robot(const RobotSummary& robot, const RobotDescription& description,
                 std::ostream& out) {
  out << "robot       " << robot.robot.hex() << '\n'
      << "label       " << robot.label << '\n'
      << "chain       " << robot.base_link << " -> " << robot.tip_link << ", " << robot.dof
      << " joints\n";
  print_transfer(description, out);
  if (!robot.geometry.empty())
    out << "geometry    " << robot.geometry
        << (robot.geometry_ms > 0 ? ", taken over at " + time_text(robot.geometry_ms) : "") << '\n';
  if (!description.meshes.empty())
    out << "meshes      " << robot.meshes << '\n';
  out << "solver      " << robot.solver << '\n'
      << "experience  " << robot.paths << " paths, " << robot.attempts << " attempts\n"
      << "registered  " << time_text(robot.registered_ms) << '\n';
}

/// Collision checks per solution in a sampling mode; "-" without a solution.
std::string checks_text(const std::optional<ModeEvidence>& mode) {
  return mode && mode->solved > 0 ? number_text(mode->checks_per_solution, 0) : "-";
}

/// A row of a sampling mode's means.
void add_means(std::string_view mode, const TaskRobotSummary& robot,
               const std::optional<PathMeans>& means, Table& table) {
  if (means)
    table.add_row({robot.label, std::string(mode), std::to_string(means->attempts),
                   duration_text(means->time_s), number_text(means->length, 2),
                   number_text(means->hand_length_m, 2), number_text(means->least_clearance_m, 3)});
}

void print_task(const TaskSummary& task, std::ostream& out) {
  out << "task        " << task.task << '\n'
      << "experience  " << kept_text(task.paths, task.dropped) << " paths, " << task.attempts
      << " attempts\n\n";
  Table table({"ROBOT",
               {"LABEL", Fit::Cut},
               "PATHS",
               "ATTEMPTS",
               "CHECKS GUIDED",
               "CHECKS UNIFORM",
               {"GENERATION", Fit::Wide}});
  for (const TaskRobotSummary& robot : task.robots)
    table.add_row({robot.robot.short_hex(), robot.label, kept_text(robot.paths, robot.dropped),
                   std::to_string(robot.attempts), checks_text(robot.guided),
                   checks_text(robot.control), std::to_string(robot.generation)});
  table.print(out);
  if (std::ranges::none_of(task.robots, [](const TaskRobotSummary& robot) {
        return robot.guided_means || robot.control_means;
      }))
    return;
  Table means(
      {{"MEANS OF SOLVED", Fit::Cut}, "MODE", "SOLVED", "TIME", "LENGTH", "HAND_M", "CLEARANCE_M"});
  for (const TaskRobotSummary& robot : task.robots) {
    add_means("guided", robot, robot.guided_means, means);
    add_means("uniform", robot, robot.control_means, means);
  }
  out << '\n';
  means.print(out);
}

void print_attempt(const Attempt& attempt, std::ostream& out) {
  const PlanningRecord& record = attempt.record;
  constexpr std::string_view kProblem = " problem=";  // the last of the options
  const std::size_t problem = record.planner_options.rfind(kProblem);
  if (problem != std::string::npos)
    out << "problem     " << record.planner_options.substr(problem + kProblem.size()) << '\n';
  out << "report      " << attempt.report_uuid.text() << '\n'
      << "robot       " << attempt.robot.short_hex() << '\n'
      << "task        " << attempt.task << '\n'
      << "machine     " << attempt.machine << '\n'
      << "outcome     " << to_text(record.outcome) << " after " << record.collision_checks
      << " collision checks, " << number_text(record.planning_time_s, 3) << " s of "
      << number_text(record.time_limit_s, 1) << " s\n"
      << "planner     " << record.planner << ' ' << record.planner_options.substr(0, problem)
      << '\n'
      << "mode        ";
  if (record.outcome == Outcome::Failed && record.sampling_mode != SamplingMode::Guided)
    out << "no sample was drawn: it could not be planned at all (planned as "
        << to_text(record.sampling_mode) << ')';
  else
    out << to_text(record.sampling_mode) << ", share " << number_text(record.share, 2);
  if (record.distribution_id)
    out << ", distribution " << record.distribution_id->short_hex() << " revision "
        << record.distribution_revision;
  out << '\n';
  if (attempt.scene)
    print_scene(*attempt.scene, out);
  if (attempt.search)
    print_search(*attempt.search, out);
  if (!attempt.path && record.outcome == Outcome::Solved)
    out << "waypoints   not kept: beyond the cap of its robot and task (kinshipd "
           "--max-paths-per-pair)\n";
  if (!attempt.path)
    return;
  constexpr int kDigits = 4;
  const Eigen::MatrixXd& waypoints = attempt.path->waypoints();
  const Eigen::Index steps = waypoints.cols() - 1;
  out << "waypoints   " << waypoints.cols() << ", "
      << number_text(
             (waypoints.rightCols(steps) - waypoints.leftCols(steps)).colwise().norm().sum(), 2)
      << " long in joint space";
  if (record.hand_length_m > 0)
    out << ", hand " << number_text(record.hand_length_m, 2) << " m, least clearance "
        << number_text(record.least_clearance_m, 3) << " m";
  out << '\n';
  for (Eigen::Index waypoint = 0; waypoint < attempt.path->size(); ++waypoint) {
    for (Eigen::Index joint = 0; joint < attempt.path->dof(); ++joint)
      out << (joint == 0 ? "  " : " ") << number_text(waypoints(joint, waypoint), kDigits);
    out << '\n';
  }
}

int show_report(link::Client& server, const Question& question, std::ostream& out,
                std::ostream& err) {
  return show(server, question, out, err, json::stored_attempt_from_json,
              [&](const json::NamedAttempt& named) { print_attempt(named.attempt, out); });
}

void print_upstream(const UpstreamStatus& upstream, std::ostream& out) {
  const auto line = [&out]() -> std::ostream& { return out << "upstream       "; };
  line() << upstream.name << (upstream.connected ? ", connected since " : ", away since ")
         << time_text(upstream.since_ms);
  if (!upstream.connected)
    out << ", tried " << upstream.tries << " times: " << upstream.message;
  out << '\n';
  line() << count_text(upstream.waiting, "report") << " to be sent";
  if (upstream.oldest_waiting_ms > 0)
    out << ", the first of " << time_text(upstream.oldest_waiting_ms);
  out << "; since start " << upstream.sent << " sent, " << upstream.received << " received for "
      << count_text(upstream.tasks, "task") << '\n';
  if (upstream.retired_above + upstream.retired_here + upstream.left_out > 0)
    line() << "since start " << count_text(upstream.retired_above, "path") << " retired above, "
           << upstream.retired_here << " here; " << count_text(upstream.left_out, "report")
           << " without a path that can be read\n";
  if (upstream.refused > 0)
    line() << count_text(upstream.refused, "report") << " refused and kept apart, e.g. "
           << upstream.first_refused << '\n';
}

void print_replica(const ReplicaUse& replica, std::ostream& out) {
  out << "host           " << replica.host << ": " << count_text(replica.readings, "reading")
      << " of fits, behind for " << replica.behind << ", failed " << replica.failed;
  if (!replica.message.empty())
    out << "; " << replica.message;
  out << '\n';
}

void print_wrong(const ServerStatus& status, std::ostream& out) {
  if (!status.writable)
    out << "wrong          " << status.storage_message << '\n';
  for (const TroubleCount& trouble : status.troubles)
    out << "trouble        " << trouble.count << " x " << trouble.what << ", last at "
        << time_text(trouble.last_ms) << ": " << trouble.last << '\n';
}

/// What is wrong first. \param is_wide  bounds also where nothing hit them.
void print_status(const ServerStatus& status, bool is_wide, std::ostream& out) {
  print_wrong(status, out);
  out << "kinshipd       " << status.version << ", up " << status.uptime_s << " s\n"
      << "store          " << status.store_file << ", " << size_text(status.store_bytes)
      << ", schema " << status.schema_version << ", epoch " << status.store_epoch.text() << '\n'
      << "writable       " << (status.writable ? "yes" : "no") << '\n';
  if (status.writable && !status.storage_message.empty())
    out << "note           " << status.storage_message << '\n';
  if (status.credentials_expire_ms > 0)
    out << "credentials    of the server end at " << time_text(status.credentials_expire_ms)
        << '\n';
  out << "holds          " << count_text(status.robots, "robot") << ", "
      << count_text(status.tasks, "task") << ", " << count_text(status.paths, "path")
      << (status.dropped_paths > 0
              ? " (" + std::to_string(status.dropped_paths) + " more were beyond the cap)"
              : "")
      << ", " << count_text(status.attempts, "attempt") << ", "
      << count_text(status.distributions, "distribution") << '\n'
      << "since start    " << count_text(status.reports_received, "report") << " ("
      << status.reports_refused << " refused), " << status.fetches << " fetches ("
      << status.fetches_from_memory << " from memory), " << count_text(status.fits, "fit") << '\n'
      << "queued         " << count_text(status.queued_reports, "report") << ", "
      << count_text(status.queued_fits, "fit") << '\n'
      << "under way      " << count_text(status.jobs, "job") << "; "
      << count_text(status.followed, "distribution") << " followed\n"
      << "rehearsals     " << status.rehearsals << " done, " << status.queued_rehearsals
      << " queued, " << number_text(status.rehearsal_time_s, 1) << " s of processor time\n";
  if (status.guided_means)
    out << "guided         " << means_text(*status.guided_means) << '\n';
  if (status.control_means)
    out << "uniform        " << means_text(*status.control_means) << '\n';
  if (status.scrubbed_ms > 0 || status.scrub_part > 0)  // a database reads its own pages
    out << "scrub          "
        << (status.scrubbed_ms > 0 ? "all read at " + time_text(status.scrubbed_ms) + ", then "
                                   : std::string())
        << number_text(100 * status.scrub_part, 0) << " % read\n";
  for (const ReplicaUse& replica : status.replicas)
    print_replica(replica, out);
  if (status.upstream)
    print_upstream(*status.upstream, out);
  for (const BoundUse& bound : status.bounds)
    if (is_wide || bound.used >= bound.limit)
      out << "bound          " << bound.used << " of " << bound.limit << ' ' << bound.what << '\n';
}

constexpr const char* kExperienceCommand = "tasks experience";

std::string position_text(const Eigen::Isometry3d& T_task_transfer) {
  constexpr int kDigits = 2;
  std::string text;
  for (const double number : T_task_transfer.translation())
    text += (text.empty() ? "" : " ") + number_text(number, kDigits);
  return text;
}

/// The labels of the robots that the paths are from; digests of robots without one.
std::map<Digest, std::string> labels_of(link::Client& server, const TaskExperience& experience) {
  std::map<Digest, std::string> labels;
  for (const PosePath& path : experience.paths)
    if (!labels.contains(path.source)) {
      const auto robot = link::find_robot(server, path.source.hex());
      labels.emplace(path.source, robot ? robot->label : path.source.short_hex());
    }
  return labels;
}

}  // namespace

int show_status(link::Client& server, bool json, std::ostream& out, std::ostream& err) {
  return show(server, {"status", {.verb = AdminVerb::Status}, json, json::kFormatOf<ServerStatus>},
              out, err, json::row_from_json<ServerStatus>, [&](const ServerStatus& status) {
                print_status(status, tables::table_layout(out).is_wide, out);
              });
}

int show_robot(link::Client& server, const std::string& name, bool json, std::ostream& out,
               std::ostream& err) {
  constexpr const char* kCommand = "robots show";
  const auto rows = link::rows_of(server, {.verb = AdminVerb::ShowRobot, .argument = name});
  if (!rows)
    return refuse(kCommand, rows.error(), err);
  constexpr std::size_t kRows = 2;  // the store's record of it, and its description
  if (rows->size() != kRows) {
    err << kCommand << ": the server sent " << rows->size() << " rows, expected " << kRows << '\n';
    return kFailed;
  }
  const std::string &summary = rows->front(), &described = rows->back();
  if (json) {
    out << json::in_format(json::kRobotDetailsFormat,
                           "{\"robot\":" + summary + ",\n\"description\":" + described + "}")
        << '\n';
    return kDone;
  }
  const auto robot = json::row_from_json<RobotSummary>(summary);
  const auto description = json::robot_description_from_json(described);
  if (!robot || !description) {
    err << kCommand << ": cannot read the server's rows: "
        << (robot ? description.error() : robot.error()).message << '\n';
    return kFailed;
  }
  print_robot(*robot, *description, out);
  return kDone;
}

int show_task(link::Client& server, const std::string& task, bool json, std::ostream& out,
              std::ostream& err) {
  return show(server,
              {"tasks show",
               {.verb = AdminVerb::ShowTask, .argument = task},
               json,
               json::kFormatOf<TaskSummary>},
              out, err, json::row_from_json<TaskSummary>,
              [&](const TaskSummary& summary) { print_task(summary, out); });
}

int show_path(link::Client& server, const std::string& id, bool json, std::ostream& out,
              std::ostream& err) {
  return show_report(
      server,
      {"paths show", {.verb = AdminVerb::ShowPath, .argument = id}, json, json::kAttemptFormat},
      out, err);
}

int show_attempt(link::Client& server, const std::string& id, bool json, std::ostream& out,
                 std::ostream& err) {
  return show_report(
      server,
      {"attempts show", {.verb = AdminVerb::ShowPath, .argument = id}, json, json::kAttemptFormat},
      out, err);
}

int show_distribution(link::Client& server, const std::string& id, bool json, std::ostream& out,
                      std::ostream& err) {
  return show(server,
              {"distributions show",
               {.verb = AdminVerb::ShowDistribution, .argument = id},
               json,
               json::kDistributionFormat},
              out, err, json::distribution_from_json,
              [&](const Distribution& distribution) { print_distribution(distribution, out); });
}

int show_experience(link::Client& server, const ExperienceOptions& options, std::ostream& out,
                    std::ostream& err) {
  FetchRequest request;
  request.task = options.task;  // and no robot: it is for any
  request.experience_bytes = options.max_bytes;
  const Result<FetchReply> reply = server.fetch(request);
  if (!reply)
    return refuse(kExperienceCommand, reply.error(), err);
  if (reply->status == FetchStatus::Refused)
    return refuse(kExperienceCommand, {ErrorCode::InvalidInput, reply->message}, err);
  if (reply->status == FetchStatus::Busy)
    return refuse(kExperienceCommand, {ErrorCode::Unavailable, reply->message}, err);
  if (!reply->experience) {
    const auto task =
        link::row_of<TaskSummary>(server, {.verb = AdminVerb::ShowTask, .argument = options.task});
    return refuse(kExperienceCommand,
                  task || task.error().code != ErrorCode::NotFound
                      ? Error{ErrorCode::NotFound,
                              "no paths of task '" + options.task + "' (see: kinship tasks list)"}
                      : task.error(),  // with the nearest name
                  err);
  }
  const TaskExperience& experience = *reply->experience;
  if (options.json) {
    out << json::to_json(experience) << '\n';
    return kDone;
  }
  const std::map<Digest, std::string> labels = labels_of(server, experience);
  Table table({{"SOURCE", Fit::Cut},
               "PATH",
               "START",
               "GOAL",
               {"START POSE", Fit::Wide},
               {"GOAL POSE", Fit::Wide}});
  for (const PosePath& path : experience.paths)
    table.add_row({labels.at(path.source), path.path.text(), position_text(path.poses.front()),
                   position_text(path.poses.back()), pose_text(path.poses.front()),
                   pose_text(path.poses.back())});
  table.print(out);
  out << experience.paths.size() << " of " << count_text(experience.paths_known, "path") << '\n';
  return kDone;
}

}  // namespace kinship::cli
