#include "robots/recall/warp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::recall {
namespace {

constexpr int kSteps = 2;              // of inverse kinematics, per waypoint
constexpr double kGoalZone = 0.15;     // last part of a path, where the hand moves with the goal
constexpr double kUnrelatedStart = 1;  // joint units: the hand's way from there tells nothing
constexpr double kSameStart = 1e-9;    // joint units

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

Warp::Warp(const Warper& warper, const WarpedPath& path, WarpTarget target, const WarpBlend& blend,
           const std::optional<Eigen::Isometry3d>& T_new_old)
    : warper_(warper),
      path_(path),
      target_(std::move(target)),
      blend_(blend),
      T_new_old_(T_new_old),
      T_start_(target_.T_base_start * path.T_base_transfer.front().inverse(Eigen::Isometry)),
      T_goal_(target_.T_base_goal * path.T_base_transfer.back().inverse(Eigen::Isometry)),
      turns_(target_.start.size()),
      moved_(path.waypoints.rows(), path.waypoints.cols()) {
  for (Eigen::Index i = 0; i < turns_.size(); ++i)
    turns_[i] = warper.turns(i, path.waypoints(i, 0), target_.start[i]);
  by_start_ = target_.start - path.waypoints.col(0) - turns_;
  by_goal_ = target_.goal - path.waypoints.rightCols<1>() - turns_;
  is_same_start_ = by_start_.norm() < kSameStart;
  is_far_start_ = by_start_.norm() > kUnrelatedStart;
  moved_.col(0) = target_.start;
  moved_.rightCols<1>() = target_.goal;
}

std::optional<Eigen::Isometry3d> Warp::move(Eigen::Index waypoint) {
  const double at = static_cast<double>(waypoint) / static_cast<double>(path_.waypoints.cols() - 1);
  const double over = std::clamp((at - blend_.begin) / (blend_.end - blend_.begin), 0.0, 1.0);
  const double turned =
      blend_.posture > 0 ? std::clamp(1 - (1 - at) / blend_.posture, 0.0, 1.0) : over;
  auto q = moved_.col(waypoint);
  q = path_.waypoints.col(waypoint) + turns_ + (1 - over) * by_start_ + turned * by_goal_;
  if (const Eigen::Index yaw = warper_.yaw_joint(); yaw >= 0)
    q[yaw] += (over - turned) * by_goal_[yaw];  // the arm faces where the furniture is
  q = q.cwiseMax(target_.bounds.row(0).transpose()).cwiseMin(target_.bounds.row(1).transpose());
  if ((is_same_start_ && over <= 0) || (is_far_start_ && over < 1))
    return std::nullopt;
  const Eigen::Isometry3d& hand = path_.T_base_transfer[static_cast<std::size_t>(waypoint)];
  Eigen::Isometry3d there = T_goal_ * hand;
  if (T_new_old_)
    there = planning::blended(*T_new_old_ * hand, there,
                              std::clamp(1 - (1 - at) / kGoalZone, 0.0, 1.0));
  return over < 1 ? planning::blended(T_start_ * hand, there, over) : there;
}

void Warp::compute(Eigen::Index stride, Eigen::Index except) {
  std::array<Eigen::Index, kRecallWaypoints> waypoints;
  std::array<Eigen::Isometry3d, kRecallWaypoints> wanted;
  std::size_t count = 0;
  for (Eigen::Index i = stride; i < moved_.cols() - 1; i += stride)
    if (const auto T = i % except != 0 ? move(i) : std::nullopt) {
      waypoints.at(count) = i;
      wanted.at(count++) = *T;
    }
  put_hands({waypoints.data(), count}, {wanted.data(), count});
  for (Eigen::Index i = stride; constraint() != nullptr && i < moved_.cols() - 1; i += stride)
    if (i % except != 0)
      project(i);
}

void Warp::project(Eigen::Index waypoint) {
  Eigen::VectorXd q = moved_.col(waypoint);
  if (constraint()->project(q))
    moved_.col(waypoint) = q;
  else
    moved_.col(waypoint).setConstant(std::numeric_limits<double>::quiet_NaN());
}

void Warp::put_hands(std::span<const Eigen::Index> waypoints,
                     std::span<const Eigen::Isometry3d> wanted) {
  const inverse::LaneChain& lanes = warper_.solver().lanes();
  inverse::LaneBatch batch;
  for (std::size_t begin = 0; begin < wanted.size(); begin += inverse::kLanes) {
    for (int lane = 0; lane < inverse::kLanes; ++lane) {
      const std::size_t at = std::min(begin + static_cast<std::size_t>(lane), wanted.size() - 1);
      const Eigen::Isometry3d& T = wanted[at];
      for (int i = 0; i < 12; ++i)
        batch.target[i][lane] = i < 9 ? T(i / 3, i % 3) : T(i - 9, 3) / lanes.length_m;
      for (int j = 0; j < lanes.dof; ++j)
        batch.q[j][lane] =
            moved_(j, waypoints[at]) * lanes.joints[j].scale + lanes.joints[j].offset;
    }
    for (int i = 0; i < kSteps; ++i)
      warper_.solver().kernels().step(lanes, inverse::LaneLimits::Hold, batch);
    for (std::size_t at = begin; at < std::min(begin + inverse::kLanes, wanted.size()); ++at)
      for (int j = 0; j < lanes.dof; ++j)
        moved_(j, waypoints[at]) =
            std::clamp((batch.q[j][at - begin] - lanes.joints[j].offset) / lanes.joints[j].scale,
                       target_.bounds(0, j), target_.bounds(1, j));
  }
}

}  // namespace kinship::recall
