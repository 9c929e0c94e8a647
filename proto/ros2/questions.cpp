#include "proto/ros2/questions.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "proto/codec/arena.hpp"
#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/reader.hpp"
#include "proto/codec/register_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "proto/types/rules.hpp"

namespace kinship::ros2 {
namespace {

using codec::Arena;
using codec::elements;
using codec::text_bytes;

template <std::size_t kSize>
void copy_bytes(const std::uint8_t (&from)[kSize], std::uint8_t (&to)[kSize]) {
  std::copy(std::begin(from), std::end(from), std::begin(to));
}

bool is_zero(const std::uint8_t (&bytes)[32]) {
  return std::ranges::all_of(bytes, [](std::uint8_t byte) { return byte == 0; });
}

/// The texts of a message live as long as it does, and are only read.
char* borrowed(const char* text) { return const_cast<char*>(text ? text : ""); }  // NOLINT: C's

void write_pose(const wire::Pose& from, double* to) {
  const double numbers[] = {from.position.x,    from.position.y,    from.position.z,
                            from.orientation.x, from.orientation.y, from.orientation.z,
                            from.orientation.w};
  std::ranges::copy(numbers, to);
}

/// None or one.
template <typename Poses, typename Numbers>
void write_placement(const Poses& from, Arena& arena, Numbers& to) {
  if (elements(from).empty())
    return;
  arena.resize(to, 7);
  write_pose(from._buffer[0], to._buffer);
}

/// Whole milliseconds; what no message of Kinship can say is said as the most that it can.
std::uint32_t milliseconds(std::string_view what, const wire::Duration& duration, Rules& rules) {
  rules.that(duration.sec >= 0,
             std::string(what) + ": " + std::to_string(duration.sec) + " s, must not be negative");
  const std::int64_t ms = std::int64_t{1000} * duration.sec + duration.nanosec / 1'000'000;
  return static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(ms, 0, std::numeric_limits<std::uint32_t>::max()));
}

/// The kinds of shape_msgs/SolidPrimitive, by number and dimensions.
struct SolidKind {
  std::uint8_t ros;
  std::uint32_t kinship;
  std::size_t dimensions;
  std::array<std::size_t, 3> order;  ///< of ROS's dimensions in Kinship's sizes
};
constexpr std::array<SolidKind, 3> kSolidKinds = {
    {{1, 0, 3, {0, 1, 2}}, {2, 2, 1, {0}}, {3, 1, 2, {1, 0}}}};

template <typename Wire>
void write_solid(const std::string& what, const wire::Solid& from, Wire& to, Rules& rules) {
  const auto sizes = elements(from.dimensions);
  const auto kind = std::ranges::find(kSolidKinds, from.type, &SolidKind::ros);
  if (kind == kSolidKinds.end() || sizes.size() != kind->dimensions) {
    rules.that(false, what + ": shape_msgs/SolidPrimitive of type " + std::to_string(from.type) +
                          " with " + std::to_string(sizes.size()) +
                          " dimensions; taken are BOX (3), SPHERE (1) and CYLINDER (2)");
    return;
  }
  to.shape = kind->kinship;
  for (std::size_t i = 0; i < kind->dimensions; ++i)
    to.size[i] = sizes[kind->order.at(i)];
}

template <typename Objects>
void write_objects(const std::string& what, const Objects& from, std::size_t limit, Arena& arena,
                   decltype(kinship_wire_RecordedScene::objects)& to, Rules& rules) {
  const auto objects = elements(from);
  if (rules.at_most("scene: " + what, objects.size(), limit).broken())
    return;
  arena.resize(to, objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    kinship_wire_SceneSolid& solid = to._buffer[i];
    solid.name = borrowed(objects[i].id);
    solid.approximate = objects[i].approximate;
    write_pose(objects[i].pose, solid.pose);
    write_solid("scene: " + what + " '" + solid.name + "'", objects[i].solid, solid, rules);
  }
}

template <typename Pairs, typename Wire>
void write_pairs(const std::string& what, const Pairs& from, std::size_t limit, Arena& arena,
                 Wire& to, Rules& rules) {
  const auto pairs = elements(from);
  if (rules.at_most(what, pairs.size(), limit).broken())
    return;
  arena.resize(to, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    to._buffer[i].first = borrowed(pairs[i].first);
    to._buffer[i].second = borrowed(pairs[i].second);
  }
}

/// Positions of the points, one after the other; sizes are checked before memory is allocated.
void write_path(const trajectory_msgs_msg_JointTrajectory& from, Arena& arena,
                kinship_wire_Attempt& to, Rules& rules) {
  const auto points = elements(from.points);
  if (points.empty())
    return;
  const std::size_t named = elements(from.joint_names).size();
  const std::size_t dof = named > 0 ? named : elements(points[0].positions).size();
  rules.at_most("trajectory: joints", dof, kMaxDof)
      .at_most("trajectory: points", points.size(), kMaxWaypoints)
      .at_most("trajectory: bytes of positions", sizeof(double) * dof * points.size(),
               kMaxBatchBytes);
  for (std::size_t i = 0; i < points.size() && !rules.broken(); ++i)
    if (const std::size_t size = elements(points[i].positions).size(); size != dof)
      rules.that(false, "trajectory: " + std::to_string(size) + " positions of point " +
                            std::to_string(i) + " for " + std::to_string(dof) + " joints");
  if (rules.broken())
    return;
  to.dof = static_cast<std::uint32_t>(dof);
  arena.resize(to.waypoints, dof * points.size());
  double* next = to.waypoints._buffer;
  for (const trajectory_msgs_msg_JointTrajectoryPoint& point : points)
    next = std::ranges::copy(elements(point.positions), next).out;
}

void write_record(const wire::PlannedPath& from, Arena& arena, kinship_wire_PlanningRecord& to) {
  to.outcome = from.outcome;
  to.planner = borrowed(from.planner);
  to.planner_options = borrowed(from.planner_options);
  to.planning_time_s = from.planning_time;
  to.time_limit_s = from.time_limit;
  to.processor_time_s = from.processor_time;
  to.collision_checks = from.collision_checks;
  to.projections = from.projections;
  to.sampling_mode = from.sampling_mode;
  to.share = from.share;
  to.distribution_revision = from.distribution_revision;
  if (is_zero(from.distribution_id))
    return;
  arena.resize(to.distribution_id, std::size(from.distribution_id));
  std::ranges::copy(from.distribution_id, to.distribution_id._buffer);
}

void write_scene(const wire::PlannedPath& from, Arena& arena, kinship_wire_RecordedScene& to,
                 Rules& rules) {
  write_objects("objects", from.objects, kMaxSceneObjects, arena, to.objects, rules);
  decltype(to.objects) held{};  // the same but for its bound
  write_objects("attached", from.attached, kMaxHeldObjects, arena, held, rules);
  to.held._length = to.held._maximum = held._length;
  to.held._buffer = held._buffer;
  write_pairs("scene: allowed_collisions", from.allowed_collisions, kMaxAllowedPairs, arena,
              to.allowed_collisions, rules);
}

template <typename Sequence>
std::size_t bytes_of_numbers(const Sequence& numbers) {
  return sizeof(double) * elements(numbers).size();
}

constexpr std::size_t kFixedBytes = 512, kSolidBytes = 192, kPairBytes = 64;

}  // namespace

Uuid read_uuid(const wire::Uuid& uuid) { return codec::read_uuid(uuid.uuid); }

Result<PathReport> read(const wire::PlannedPath& path) {
  Arena arena;
  Rules rules;
  kinship_wire_ReportRequest request{};
  arena.resize(request.attempts, 1);
  kinship_wire_Attempt& attempt = request.attempts._buffer[0];
  copy_bytes(path.uuid.uuid, attempt.report_uuid);
  copy_bytes(path.robot, attempt.robot);
  attempt.machine = borrowed(path.machine);
  attempt.task = borrowed(path.task);
  write_placement(path.base, arena, attempt.T_task_base);
  arena.resize(attempt.record, 1);
  write_record(path, arena, attempt.record._buffer[0]);
  write_path(path.trajectory, arena, attempt, rules);
  if (path.has_scene && !rules.broken()) {
    arena.resize(attempt.scene, 1);
    write_scene(path, arena, attempt.scene._buffer[0], rules);
  }
  PathReport report;
  if (rules.broken()) {
    report.request.refused.push_back(
        {read_uuid(path.uuid), ReceiptStatus::Refused, rules.broken()->message});
    return report;
  }
  Result<ReportRequest> decoded = codec::decode(request);
  if (!decoded)
    return decoded.error();
  report.request = std::move(decoded).value();
  for (const char* const name : elements(path.trajectory.joint_names))
    report.joint_names.push_back(codec::read_text(name));
  return report;
}

Result<RobotDescription> read(const wire::Registration& registration) {
  Arena arena;
  Rules rules;
  kinship_wire_RegisterRequest request{};
  request.label = borrowed(registration.label);
  request.urdf = borrowed(registration.urdf);
  request.base_link = borrowed(registration.base_link);
  request.tip_link = borrowed(registration.tip_link);
  write_pose(registration.tip_to_tool, request.T_tip_transfer);
  std::ranges::copy(registration.task_axes, std::begin(request.task_axes));
  const auto held = elements(registration.held_joints);
  const auto solids = elements(registration.mesh_solids);
  rules.at_most("held_joints", held.size(), kMaxHeldJoints)
      .at_most("mesh_solids", solids.size(), kMaxMeshSolids);
  if (rules.broken())
    return *rules.broken();
  arena.resize(request.held_joints, held.size());
  for (std::size_t i = 0; i < held.size(); ++i)
    request.held_joints._buffer[i] = {borrowed(held[i].joint), held[i].position};
  arena.resize(request.mesh_solids, solids.size());
  for (std::size_t i = 0; i < solids.size(); ++i) {
    kinship_wire_LinkSolid& solid = request.mesh_solids._buffer[i];
    solid.link = borrowed(solids[i].link);
    write_pose(solids[i].pose, solid.pose);
    write_solid(std::string("mesh_solids: link '") + solid.link + "'", solids[i].solid, solid,
                rules);
  }
  write_pairs("never_colliding", registration.never_colliding, kMaxCollisionPairs, arena,
              request.never_colliding, rules);
  write_pairs("unfiltered", registration.unfiltered, kMaxCollisionPairs, arena, request.unfiltered,
              rules);
  if (rules.broken())
    return *rules.broken();
  return codec::decode(request);
}

Result<FetchRequest> read(const wire::DistributionQuery& query) {
  constexpr std::uint32_t kMsOfSecond = 1000;
  Arena arena;
  Rules rules;
  kinship_wire_FetchRequest request{};
  request.task = borrowed(query.task);
  copy_bytes(query.robot, request.robot);
  write_placement(query.base, arena, request.T_task_base);
  request.profile = borrowed(query.profile);
  request.minimum_generation = query.minimum_generation;
  request.deadline_ms = milliseconds("deadline", query.deadline, rules);
  const std::uint32_t follow_ms = milliseconds("follow", query.follow, rules);
  request.follow_s = follow_ms / kMsOfSecond + (follow_ms % kMsOfSecond > 0 ? 1 : 0);
  if (rules.broken())
    return *rules.broken();
  return codec::decode(request);
}

codec::RequestSize size_of(const wire::PlannedPath& path) {
  codec::RequestSize size{.bytes = kFixedBytes, .attempts = 1};
  for (const trajectory_msgs_msg_JointTrajectoryPoint& point : elements(path.trajectory.points))
    size.bytes += bytes_of_numbers(point.positions) + bytes_of_numbers(point.velocities) +
                  bytes_of_numbers(point.accelerations) + bytes_of_numbers(point.effort);
  size.bytes += kSolidBytes * (elements(path.objects).size() + elements(path.attached).size()) +
                kPairBytes * elements(path.allowed_collisions).size();
  return size;
}

codec::RequestSize size_of(const wire::Registration& registration) {
  return {.bytes = kFixedBytes + text_bytes(registration.urdf) +
                   kSolidBytes * elements(registration.mesh_solids).size() +
                   kPairBytes * (elements(registration.never_colliding).size() +
                                 elements(registration.unfiltered).size())};
}

codec::RequestSize size_of(const wire::DistributionQuery& query) {
  return {.bytes = kFixedBytes + text_bytes(query.task) + text_bytes(query.profile)};
}

codec::RequestSize size_of(const wire::StatusQuery& /*query*/) { return {.bytes = kFixedBytes}; }

std::optional<Error> order_joints(PathReport& report, const std::vector<std::string>& joints) {
  std::vector<Attempt>& attempts = report.request.attempts;
  const std::vector<std::string>& names = report.joint_names;
  if (attempts.empty() || !attempts[0].path || names.empty() || names == joints)
    return std::nullopt;
  if (std::set<std::string>(names.begin(), names.end()).size() != names.size())
    return Error{ErrorCode::InvalidInput, "trajectory: a joint is named twice"};
  const Eigen::MatrixXd& told = attempts[0].path->waypoints();
  Eigen::MatrixXd ordered(static_cast<Eigen::Index>(joints.size()), told.cols());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto place = std::ranges::find(names, joints[i]);
    if (place == names.end())
      return Error{ErrorCode::InvalidInput,
                   "trajectory: joint '" + joints[i] + "' of the robot's chain is missing"};
    ordered.row(static_cast<Eigen::Index>(i)) = told.row(place - names.begin());
  }
  attempts[0].path = Path(std::move(ordered));
  return std::nullopt;
}

}  // namespace kinship::ros2
