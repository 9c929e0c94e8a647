#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "client/guided/scene_record.hpp"
#include "client/link/environment.hpp"
#include "proto/evidence/machine_speed.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/recorded_scene.hpp"

namespace kinship::c_library {
namespace {

link::ClientOptions read_options(const kinship_client_options& given) {
  link::ClientOptions options;
  options.domain =
      given.domain == KINSHIP_ENVIRONMENT ? link::domain_from_environment() : given.domain;
  options.server = given.server != nullptr ? given.server : link::server_from_environment();
  options.security = text_or_empty(given.security);
  options.outbox = text_or_empty(given.outbox);
  options.has_outbox = given.without_outbox == 0;
  options.timeout = given.timeout_ms != 0 ? std::chrono::milliseconds(given.timeout_ms)
                                          : link::timeout_from_environment();
  options.resend = link::parse_resend(text_or_empty(given.resend)).value_or_throw();
  return options;
}

Path read_path(const kinship_attempt& given) {
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

/// As the server keeps it: solids around meshes, boxes around voxels.
RecordedScene record(const GivenScene& given) {
  RecordedScene scene = guided::SceneRecords().record(given.scene, given.held, {}).value_or_throw();
  scene.allowed_collisions = given.allowed_collisions;  // unknown names are told
  return scene;
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
  attempt.record.processor_time_s = given.processor_time_s;
  if (given.processor_time_s > 0)
    attempt.record.machine_speed = evidence::machine_speed();
  if (given.solved != 0)
    attempt.path = read_path(given);
  if (given.objects != nullptr || given.object_count > 0)
    attempt.scene = record(read_scene({given.objects, given.object_count, given.allowed_collisions,
                                       given.allowed_collision_pairs},
                                      "attempt"));
  else if (given.allowed_collision_pairs > 0)
    throw Failure(invalid_input("attempt->allowed_collision_pairs is " +
                                std::to_string(given.allowed_collision_pairs) +
                                ", must be 0 without attempt->objects"));
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

std::string text_or_empty(const char* text) { return text == nullptr ? std::string() : text; }

std::vector<std::pair<std::string, std::string>> read_pairs(const char* const* names,
                                                            std::size_t pairs, const char* name) {
  const std::string which = std::string("a name in ") + name;
  if (pairs > 0)
    require(names, name);
  std::vector<std::pair<std::string, std::string>> read;
  for (std::size_t i = 0; i < pairs; ++i) {
    require(names[2 * i], which.c_str());
    require(names[2 * i + 1], which.c_str());
    read.emplace_back(names[2 * i], names[2 * i + 1]);
  }
  return read;
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

const char* kinship_client_warning(const kinship_client* client) {
  thread_local std::string warning;
  warning.clear();
  guarded([&] {
    require(client, "client");
    warning = client->line.expiry_warning().value_or("");
    return KINSHIP_OK;
  });
  return warning.c_str();
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
    thread_local std::string last_refusal;
    last_refusal = state.last_refusal;
    std::size_t kept = 0;
    for (const kinship::link::KeptReports& each : state.kept)
      kept += each.reports;
    if (outbox != nullptr)
      write_structure({0, state.pending, state.accepted, state.refused, last_refusal.c_str(), kept},
                      outbox, "outbox");
    if (state.pending > 0)
      return remember(KINSHIP_UNAVAILABLE,
                      std::to_string(state.pending) + " reports wait: " + state.problem);
    return KINSHIP_OK;
  });
}
