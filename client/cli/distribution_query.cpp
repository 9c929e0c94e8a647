#include "client/cli/distribution_query.hpp"

#include <ostream>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/reported_placement.hpp"
#include "client/link/robot_names.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::cli {
namespace {

/// The commands that help if the server does not know the robot.
Error with_advice(Error error) {
  if (error.code == ErrorCode::NotFound)
    error.message += " (see: kinship robots list, kinship robots register)";
  return error;
}

/// Where the robot stood when it last reported the task, told on `err`; missing: it has not, or the
/// server does not tell.
std::optional<Eigen::Isometry3d> known_placement(link::Client& server, const std::string& task,
                                                 const std::string& robot, std::string_view command,
                                                 std::ostream& err) {
  const auto known = link::reported_placement(server, task, robot);
  err << command << ": ";
  if (known && known->T_task_base)
    err << "placement " << pose_text(*known->T_task_base) << ", of the newest attempt of '" << robot
        << "'; --placement names another\n";
  else
    err << "no --placement, taken as 0 0 0 0 0 0 1: "
        << (!known            ? known.error().message
            : known->is_known ? "the newest attempt of '" + robot + "' has none"
                              : "'" + robot + "' has not reported the task")
        << '\n';
  return known ? known->T_task_base : std::nullopt;
}

Result<FetchRequest> request_for(link::Client& server, const DistributionQuery& query,
                                 std::string_view command, std::ostream& err) {
  FetchRequest request;
  request.task = query.task;
  request.profile = query.profile;
  request.deadline = query.wait;
  if (!query.placement.empty()) {
    const auto T_task_base = models::parse_pose(query.placement);
    if (!T_task_base)
      return Error{T_task_base.error().code, "--placement: " + T_task_base.error().message};
    request.T_task_base = *T_task_base;
  }
  const auto selection =
      arguments::read_selection(query.selection, std::chrono::system_clock::now());
  if (!selection)
    return selection.error();
  request.selection = *selection;
  const auto robot = link::find_robot(server, query.robot);
  if (!robot)
    return with_advice(robot.error());
  request.robot = robot->robot;
  if (!request.T_task_base)
    request.T_task_base = known_placement(server, query.task, robot->label, command, err);
  if (!query.selection.sources.empty()) {
    const auto names = arguments::parse_robot_names(query.selection.sources);
    if (!names)
      return names.error();
    const auto sources = link::resolve_robots(server, *names);
    if (!sources)
      return with_advice(sources.error());
    request.selection.sources = *sources;
  }
  return request;
}

/// Says why there is no distribution to print. \return an exit code, kDone if there is one.
int judge(const Result<FetchReply>& reply, const DistributionQuery& query, std::string_view command,
          bool allow_failed, std::ostream& err) {
  if (!reply)
    return refuse(command, reply.error(), err);
  const auto say = [&](const std::string& what) {
    err << command << ": " << what << (reply->message.empty() ? "" : ": ") << reply->message
        << '\n';
  };
  switch (reply->status) {
    case FetchStatus::Ready:
      return kDone;
    case FetchStatus::NoExperience:
      say("no experience");
      return kNotFound;
    case FetchStatus::UnknownRobot:
      say("unknown robot");
      return kNotFound;
    case FetchStatus::Pending:
      say("still being made after " +
          number_text(1e-3 * static_cast<double>(query.wait.count()), 1) + " s (--wait)");
      return kFailed;
    case FetchStatus::Busy:
      say("the server is busy");
      return kFailed;
    case FetchStatus::Refused:
      say("refused");
      return kWrongUsage;
    default:
      if (allow_failed && reply->distribution)
        return kDone;
      say("failed");
      return kFailed;
  }
}

}  // namespace

std::optional<Distribution> fetch_query(link::Client& server, const DistributionQuery& query,
                                        std::string_view command, bool allow_failed,
                                        std::ostream& err, int& code) {
  const Result<FetchRequest> request = request_for(server, query, command, err);
  if (!request) {
    code = refuse(command, request.error(), err);
    return std::nullopt;
  }
  Result<FetchReply> reply = server.fetch(*request);
  code = judge(reply, query, command, allow_failed, err);
  if (code != kDone)
    return std::nullopt;
  return std::move(reply).value().distribution;
}

std::string id_of_query(link::Client& server, const DistributionQuery& query,
                        std::string_view command, bool allow_failed, std::ostream& err, int& code) {
  if (!query.id.empty())
    return query.id;
  const auto distribution = fetch_query(server, query, command, allow_failed, err, code);
  return distribution ? distribution->id.hex() : std::string();
}

}  // namespace kinship::cli
