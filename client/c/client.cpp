#include <algorithm>
#include <chrono>
#include <string>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "client/link/environment.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/types/pose.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::c_library {
namespace {

std::string text_or_empty(const char* text) { return text == nullptr ? std::string() : text; }

link::ClientOptions read_options(const kinship_client_options& given) {
  link::ClientOptions options;
  options.domain = given.domain;
  if (given.server != nullptr)
    options.server = given.server;
  options.outbox = text_or_empty(given.outbox);
  options.has_outbox = given.without_outbox == 0;
  if (given.timeout_ms != 0)
    options.timeout = std::chrono::milliseconds(given.timeout_ms);
  return options;
}

RobotDescription read_description(const kinship_robot_description& given) {
  require(given.urdf, "description->urdf");
  require(given.base_link, "description->base_link");
  require(given.tip_link, "description->tip_link");
  require(given.label, "description->label");
  RobotDescription description;
  description.label = given.label;
  description.urdf = given.urdf;
  description.base_link = given.base_link;
  description.tip_link = given.tip_link;
  if (given.T_tip_transfer != nullptr)
    description.T_tip_transfer = read_pose(given.T_tip_transfer, "description->T_tip_transfer");
  if (given.never_colliding_pairs > 0)
    require(given.never_colliding, "description->never_colliding");
  for (std::size_t i = 0; i < given.never_colliding_pairs; ++i) {
    const char* const first = given.never_colliding[2 * i];
    const char* const second = given.never_colliding[2 * i + 1];
    require(first, "a name in description->never_colliding");
    require(second, "a name in description->never_colliding");
    description.never_colliding.emplace_back(first, second);
  }
  return description;
}

Path read_path(const kinship_attempt& given) {
  constexpr std::size_t kMaxWaypoints = std::size_t{1} << 24U;  // the contract's limit is lower
  require(given.waypoints, "attempt->waypoints");
  if (given.dof < 1 || given.dof > static_cast<std::size_t>(kMaxDof))
    throw Failure(invalid_input("attempt->dof is " + std::to_string(given.dof) + ", must be 1 to " +
                                std::to_string(kMaxDof)));
  if (given.waypoint_count < 2 || given.waypoint_count > kMaxWaypoints)
    throw Failure(invalid_input("attempt->waypoint_count is " +
                                std::to_string(given.waypoint_count) + ", must be 2 to " +
                                std::to_string(kMaxWaypoints)));
  return Path(Eigen::Map<const Eigen::MatrixXd>(given.waypoints,
                                                static_cast<Eigen::Index>(given.dof),
                                                static_cast<Eigen::Index>(given.waypoint_count)));
}

SamplingMode read_sampling(kinship_sampling given) {
  switch (given) {
    case KINSHIP_UNIFORM:
      return SamplingMode::Uniform;
    case KINSHIP_GUIDED:
      return SamplingMode::Guided;
    case KINSHIP_CONTROL:
      return SamplingMode::Control;
    case KINSHIP_SAMPLING_WIDTH:
      break;
  }
  throw Failure(invalid_input("attempt->sampling is " + std::to_string(given) + ", must be 0 to " +
                              std::to_string(KINSHIP_CONTROL)));
}

Attempt read_attempt(const kinship_attempt& given) {
  require(given.task, "attempt->task");
  Attempt attempt;
  attempt.report_uuid = Uuid::random();
  attempt.robot = read_robot(given.robot, "attempt->robot");
  attempt.machine = text_or_empty(given.machine);
  attempt.task = given.task;
  if (given.T_task_base != nullptr)
    attempt.T_task_base = read_pose(given.T_task_base, "attempt->T_task_base");
  attempt.record.outcome = given.solved != 0 ? Outcome::Solved : Outcome::Failed;
  attempt.record.planner = text_or_empty(given.planner);
  attempt.record.planning_time_s = given.planning_time_s;
  attempt.record.time_limit_s = given.time_limit_s;
  attempt.record.collision_checks = given.collision_checks;
  attempt.record.sampling_mode = read_sampling(given.sampling);
  attempt.record.share = given.share;
  if (given.solved != 0)
    attempt.path = read_path(given);
  return attempt;
}

}  // namespace

Eigen::Isometry3d read_pose(const double* numbers, const char* name) {
  PoseArray pose;
  std::copy_n(numbers, pose.size(), pose.begin());
  const Result<Eigen::Isometry3d> T_a_b = from_pose_array(pose);
  if (!T_a_b)
    throw Failure(T_a_b.error().code, std::string(name) + ": " + T_a_b.error().message);
  return *T_a_b;
}

Digest read_robot(const kinship_robot* robot, const char* name) {
  require(robot, name);
  Digest digest;
  std::copy_n(robot->digest, digest.bytes.size(), digest.bytes.begin());
  return digest;
}

}  // namespace kinship::c_library

using namespace kinship::c_library;

kinship_code kinship_client_open(const kinship_client_options* options, kinship_client** client) {
  return guarded([&] {
    require(client, "client");
    *client = nullptr;
    *client =
        new kinship_client(options == nullptr ? kinship::link::options_from_environment()
                                              : read_options(read_structure(options, "options")));
    return KINSHIP_OK;
  });
}

void kinship_client_close(kinship_client* client) { delete client; }

kinship_code kinship_register(kinship_client* client, const kinship_robot_description* description,
                              kinship_robot* robot, size_t* dof) {
  return guarded([&] {
    require(client, "client");
    require(robot, "robot");
    const kinship::RobotDescription read =
        read_description(read_structure(description, "description"));
    const auto chain = kinship::kinematics::read_chain(read).value_or_throw();
    const kinship::Digest digest = chain.digest();
    std::ranges::copy(digest.bytes, robot->digest);
    if (dof != nullptr)
      *dof = static_cast<size_t>(chain.dof());
    const auto reply = client->line.register_robot(read);
    if (!reply)
      return remember(reply.error());
    return reply->status == kinship::RegisterStatus::Refused
               ? remember(KINSHIP_REFUSED, reply->message)
               : KINSHIP_OK;
  });
}

kinship_code kinship_report(kinship_client* client, const kinship_attempt* attempt) {
  return guarded([&] {
    require(client, "client");
    client->line.report(read_attempt(read_structure(attempt, "attempt")));
    return KINSHIP_OK;
  });
}

kinship_code kinship_report_line(kinship_client* client, const char* line) {
  return guarded([&] {
    require(client, "client");
    require(line, "line");
    const auto read = kinship::json::attempt_from_json(line).value_or_throw();
    if (!read.label.empty())
      return remember(KINSHIP_INVALID_INPUT, "the line names its robot '" + read.label +
                                                 "', must be 64 hexadecimal digits");
    client->line.report(read.attempt);
    return KINSHIP_OK;
  });
}

kinship_code kinship_flush(kinship_client* client, uint32_t timeout_ms, kinship_outbox* outbox) {
  return guarded([&] {
    require(client, "client");
    const auto state = client->line.flush(std::chrono::milliseconds(timeout_ms));
    if (outbox != nullptr)
      write_structure({0, state.pending, state.accepted, state.refused}, outbox, "outbox");
    return state.pending == 0
               ? KINSHIP_OK
               : remember(KINSHIP_UNAVAILABLE,
                          std::to_string(state.pending) + " reports wait: " + state.problem);
  });
}
