#include "robots/recall/warp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::recall {
namespace {

constexpr int kSteps = 2;            // of inverse kinematics, per waypoint
constexpr double kGoalZone = 0.15;   // last part of a path, where the hand moves with the goal
constexpr double kSameStart = 1e-9;  // joint units

/// Between two poses: a at 0, b at 1. Rotations by normalised linear interpolation.
Eigen::Isometry3d between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double weight) {
  if (weight <= 0)
    return a;
  if (weight >= 1)
    return b;
  const Eigen::Quaterniond from(a.linear());
  Eigen::Quaterniond to(b.linear());
  if (from.dot(to) < 0)
    to.coeffs() *= -1;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond((1 - weight) * from.coeffs() + weight * to.coeffs())
                      .normalized()
                      .toRotationMatrix();
  pose.translation() = (1 - weight) * a.translation() + weight * b.translation();
  return pose;
}

/// The first joint whose axis is vertical in the base link at any configuration of those before,
/// all of which slide.
Eigen::Index find_yaw_joint(const kinematics::Chain& chain) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  constexpr double kVertical = 0.99;
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const kinematics::Joint& joint = chain.joints()[static_cast<std::size_t>(i)];
    R = R * joint.T_previous_joint.linear();
    if (joint.type == kinematics::JointType::Prismatic)
      continue;
    return std::abs((R * joint.axis).z()) > kVertical ? i : -1;
  }
  return -1;
}

}  // namespace

Warper::Warper(const kinematics::Chain& chain)
    : chain_(chain),
      solver_(chain),
      turning_(planning::turning_joints(chain)),
      yaw_joint_(find_yaw_joint(chain)) {}

WarpedPath Warper::posed(Eigen::MatrixXd waypoints) const {
  WarpedPath path;
  path.T_base_transfer.reserve(static_cast<std::size_t>(waypoints.cols()));
  for (const auto& q : waypoints.colwise())
    path.T_base_transfer.push_back(kinematics::T_base_transfer(chain_, q));
  path.waypoints = std::move(waypoints);
  return path;
}

Eigen::VectorXd Warper::turns(const Eigen::Ref<const Eigen::VectorXd>& from,
                              const Eigen::Ref<const Eigen::VectorXd>& to) const {
  Eigen::VectorXd turns = Eigen::VectorXd::Zero(from.size());
  for (Eigen::Index i = 0; i < turns.size(); ++i)
    if (turning_[static_cast<std::size_t>(i)])
      turns[i] = planning::kTurn * std::round((to[i] - from[i]) / planning::kTurn);
  return turns;
}

Eigen::MatrixXd Warper::warp(const WarpedPath& path, const WarpTarget& target,
                             const WarpBlend& blend,
                             const std::optional<Eigen::Isometry3d>& T_new_old) const {
  const Eigen::Index count = path.waypoints.cols();
  Eigen::MatrixXd moved = path.waypoints.colwise() + turns(path.waypoints.col(0), target.start);
  const Eigen::VectorXd by_start = target.start - moved.col(0);
  const Eigen::VectorXd by_goal = target.goal - moved.rightCols<1>();
  const bool is_same_start = by_start.norm() < kSameStart;
  const Eigen::Isometry3d T_start = target.T_base_start * path.T_base_transfer.front().inverse();
  const Eigen::Isometry3d T_goal = target.T_base_goal * path.T_base_transfer.back().inverse();
  const Eigen::VectorXd lower = target.bounds.row(0), upper = target.bounds.row(1);
  std::vector<Eigen::Isometry3d> wanted;
  wanted.reserve(static_cast<std::size_t>(count));
  Eigen::Index first = 1;  // waypoint whose hand is put right
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = static_cast<double>(i) / static_cast<double>(count - 1);
    const double over = std::clamp((at - blend.begin) / (blend.end - blend.begin), 0.0, 1.0);
    const double turned =
        blend.posture > 0 ? std::clamp(1 - (1 - at) / blend.posture, 0.0, 1.0) : over;
    moved.col(i) += (1 - over) * by_start + turned * by_goal;
    if (yaw_joint_ >= 0)  // the arm faces where the furniture is, whatever its posture
      moved(yaw_joint_, i) += (over - turned) * by_goal[yaw_joint_];
    moved.col(i) = moved.col(i).cwiseMax(lower).cwiseMin(upper);
    if (i == 0 || i == count - 1)
      continue;
    if (is_same_start && over <= 0) {
      first = i + 1;
      continue;
    }
    const Eigen::Isometry3d& hand = path.T_base_transfer[static_cast<std::size_t>(i)];
    const double with_goal = T_new_old ? std::clamp(1 - (1 - at) / kGoalZone, 0.0, 1.0) : 1.0;
    const Eigen::Isometry3d there =
        T_new_old ? between(*T_new_old * hand, T_goal * hand, with_goal) : T_goal * hand;
    wanted.push_back(is_same_start ? between(hand, there, over)
                                   : between(T_start * hand, there, over));
  }
  moved.col(0) = target.start;
  put_hands(wanted, first, moved);
  for (Eigen::Index i = 1; i < count - 1; ++i)
    moved.col(i) = moved.col(i).cwiseMax(lower).cwiseMin(upper);
  moved.col(count - 1) = target.goal;
  return moved;
}

void Warper::put_hands(std::span<const Eigen::Isometry3d> wanted, Eigen::Index first,
                       Eigen::MatrixXd& waypoints) const {
  const inverse::LaneChain& lanes = solver_.lanes();
  inverse::LaneBatch batch;
  for (std::size_t begin = 0; begin < wanted.size(); begin += inverse::kLanes) {
    for (int lane = 0; lane < inverse::kLanes; ++lane) {
      const std::size_t at = std::min(begin + static_cast<std::size_t>(lane), wanted.size() - 1);
      const Eigen::Isometry3d& T = wanted[at];
      for (int i = 0; i < 12; ++i)
        batch.target[i][lane] = i < 9 ? T(i / 3, i % 3) : T(i - 9, 3) / lanes.length_m;
      for (int j = 0; j < lanes.dof; ++j)
        batch.q[j][lane] =
            waypoints(j, first + static_cast<Eigen::Index>(at)) * lanes.joints[j].scale +
            lanes.joints[j].offset;
    }
    for (int i = 0; i < kSteps; ++i)
      solver_.kernels().step(lanes, inverse::LaneLimits::Hold, batch);
    for (std::size_t at = begin; at < std::min(begin + inverse::kLanes, wanted.size()); ++at)
      for (int j = 0; j < lanes.dof; ++j)
        waypoints(j, first + static_cast<Eigen::Index>(at)) =
            (batch.q[j][at - begin] - lanes.joints[j].offset) / lanes.joints[j].scale;
  }
}

}  // namespace kinship::recall
