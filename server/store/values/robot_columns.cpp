#include "server/store/values/robot_columns.hpp"

#include <utility>

#include "server/store/values/byte_stream.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/mesh_solids_blob.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kRemoved = "removed ";

}  // namespace

std::int64_t mask_of(const TaskAxes& axes) {
  std::int64_t mask = 0;
  for (std::size_t i = 0; i < axes.matters.size(); ++i)
    if (axes.matters[i])
      mask |= std::int64_t{1} << i;
  return mask;
}

TaskAxes axes_of(std::int64_t mask) {
  TaskAxes axes;
  for (std::size_t i = 0; i < axes.matters.size(); ++i)
    axes.matters[i] = ((mask >> i) & 1) != 0;
  return axes;
}

bool has_geometry_row(const RobotRecord& robot) {
  return robot.geometry_revision > 0 || !robot.description.mesh_solids.solids.empty() ||
         !robot.description.meshes.empty();
}

std::uint32_t robot_crc(const RobotRecord& robot, Bytes T_tip_transfer, Bytes mesh_solids) {
  const RobotDescription& description = robot.description;
  ByteWriter all;
  all.add(Bytes(robot.digest.bytes)).add(std::uint64_t{robot.dof}).add(description.label);
  all.add(description.urdf).add(description.base_link).add(description.tip_link);
  all.add(T_tip_transfer).add(static_cast<std::uint64_t>(mask_of(description.task_axes)));
  for (const auto& [joint, position] : description.held_joints)
    all.add(joint).add(position);
  for (const auto& [a, b] : description.never_colliding)
    all.add(a).add(b);
  if (has_geometry_row(robot))
    all.add(robot.geometry_revision)
        .add(static_cast<std::uint64_t>(robot.geometry_ms))
        .add(Bytes(mesh_solids));
  return crc32c(all.bytes());
}

std::optional<RobotRecord> complete_robot(RobotRecord robot, Bytes T_tip_transfer,
                                          Bytes mesh_solids, std::int64_t crc) {
  std::optional<StoredGeometry> geometry = decode_geometry(mesh_solids);
  if (!geometry)
    return std::nullopt;
  robot.description.mesh_solids = std::move(geometry->solids);
  robot.description.meshes = std::move(geometry->meshes);
  if (robot_crc(robot, T_tip_transfer, mesh_solids) != crc)
    return std::nullopt;
  const std::optional<Eigen::Isometry3d> pose = pose_from_blob(T_tip_transfer);
  if (!pose)
    return std::nullopt;
  robot.description.T_tip_transfer = *pose;
  return robot;
}

std::optional<Error> find_pose_fault(const RobotDescription& description) {
  if (pose_from_blob(pose_blob(description.T_tip_transfer)))
    return std::nullopt;
  return Error{ErrorCode::InvalidInput,
               "robot '" + description.label + "': T_tip_transfer is no pose"};
}

std::optional<RobotRecord> with_better_geometry(const std::optional<RobotRecord>& before,
                                                RobotRecord better) {
  if (!before || is_removed_label(before->description.label) ||
      before->geometry_revision + 1 != better.geometry_revision ||
      find_pose_fault(better.description))
    return std::nullopt;
  better.description.label = before->description.label;
  better.registered_ms = before->registered_ms;
  return better;
}

std::string removed_label(const Digest& robot) {
  constexpr std::size_t kDigits = 24;
  return std::string(kRemoved) + robot.hex().substr(0, kDigits);
}

bool is_removed_label(std::string_view label) { return label.starts_with(kRemoved); }

Error label_conflict(const std::string& label) {
  return {ErrorCode::Conflict,
          "another robot has the label '" + label +
              "': one with another URDF, base or tip link, transfer frame, axes or held "
              "joints. Take another label, or free this one: 'kinship robots rename " +
              label + " NEW' keeps that robot under a new name, 'kinship robots remove " + label +
              "' takes it out"};
}

}  // namespace kinship::store
