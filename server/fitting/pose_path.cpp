#include "server/fitting/pose_path.hpp"

#include <cmath>
#include <exception>

#include "proto/types/limits.hpp"
#include "proto/types/profile.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/resample.hpp"

namespace kinship::fitting {
namespace {

/// So small that every path with a length has all its poses.
constexpr double kSmallestSpacing = 1e-9;

bool is_sendable(const Eigen::Isometry3d& T_task_transfer) {
  return T_task_transfer.matrix().allFinite() &&
         T_task_transfer.translation().cwiseAbs().maxCoeff() <= kMaxPlacement_m;
}

}  // namespace

std::optional<PosePath> pose_path(const store::StoredPath& stored, const runtime::Robot& robot) {
  if (stored.path.dof() != robot.chain.dof())
    return std::nullopt;
  TransferParameters parameters;
  parameters.pose_spacing = kSmallestSpacing;
  parameters.max_poses_per_path = kExperiencePoses;
  parameters.dropped_end_share = 0;
  Eigen::MatrixXd waypoints;
  try {
    waypoints = kinematics::resample(stored.path, parameters);
  } catch (const std::exception&) {  // its length overflows
    return std::nullopt;
  }
  if (waypoints.cols() < Eigen::Index{kMinPosesOfPath})
    return std::nullopt;
  const Eigen::Isometry3d T_task_base = stored.T_task_base.value_or(Eigen::Isometry3d::Identity());
  PosePath path{robot.digest, stored.report_uuid, {}};
  path.poses.reserve(static_cast<std::size_t>(waypoints.cols()));
  for (Eigen::Index i = 0; i < waypoints.cols(); ++i) {
    path.poses.push_back(T_task_base * kinematics::T_base_transfer(robot.chain, waypoints.col(i)));
    if (!is_sendable(path.poses.back()))
      return std::nullopt;
  }
  return path;
}

}  // namespace kinship::fitting
