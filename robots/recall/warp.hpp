#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/recall_library.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::recall {

/// Where along a path, in parts of its length, its motion goes over from the query's start to the
/// furniture, and the last part in which its posture turns to that of the goal.
struct WarpBlend {
  double begin = 0, end = 0;
  double posture = 0;  ///< 0: the posture turns while the motion goes over
};

/// By WarpMode::blend.
inline constexpr std::array<WarpBlend, 3> kWarpBlends = {
    {{0, 0.25, 0.4}, {0.1, 0.4, 0.4}, {0, 0.25, 0}}};
static_assert(kWarpBlends.size() == kMaxWarpBlends);

/// A path and where the hand was along it.
struct WarpedPath {
  Eigen::MatrixXd waypoints;                       ///< dof x kRecallWaypoints
  std::vector<Eigen::Isometry3d> T_base_transfer;  ///< at each waypoint
};

/// What a path is moved onto.
struct WarpTarget {
  Eigen::Matrix2Xd bounds;                      ///< 2 x dof (planning_bounds)
  Eigen::VectorXd start, goal;                  ///< dof, within bounds
  Eigen::Isometry3d T_base_start, T_base_goal;  ///< of the transfer frame
  /// That the path keeps; null: none. Counts the projections.
  planning::RegionConstraint* constraint = nullptr;
};

/// Moves whole paths of one robot onto queries.
class Warper {
 public:
  explicit Warper(const kinematics::Chain& chain);

  /// Hand poses along a path, for `Warp`.
  WarpedPath posed(Eigen::MatrixXd waypoints) const;

  /// Full turns that bring a configuration nearest to another one; 0 for joints that have no more
  /// than a turn of room.
  double turns(Eigen::Index joint, double from, double to) const {
    return turning_[static_cast<std::size_t>(joint)]
               ? planning::kTurn * std::round((to - from) / planning::kTurn)
               : 0;
  }

  /// The first joint that turns the whole arm about the vertical; -1: none.
  Eigen::Index yaw_joint() const noexcept { return yaw_joint_; }
  const kinematics::Chain& chain() const noexcept { return chain_; }
  const inverse::Solver& solver() const noexcept { return solver_; }

 private:
  kinematics::Chain chain_;
  inverse::Solver solver_;
  std::vector<bool> turning_;
  Eigen::Index yaw_joint_ = -1;
};

/// A path with the start and goal of a query, computed waypoint by waypoint: its joints are moved
/// by the offsets of start and goal, then two damped steps of inverse kinematics a waypoint put the
/// hand where it was in a frame, near the start and the goal where it was with respect to these,
/// and it is projected onto the constraint. It keeps within the bounds, and is checked for nothing
/// else.
class Warp {
 public:
  /// Borrows all but the target, of which it borrows the constraint.
  /// \param T_new_old  of the frame, in the base link: its pose at the query times the inverse of
  ///                   its pose when the path was planned; nothing: the goal's motion.
  Warp(const Warper& warper, const WarpedPath& path, WarpTarget target, const WarpBlend& blend,
       const std::optional<Eigen::Isometry3d>& T_new_old);

  /// Computes the waypoints at multiples of a stride that are no multiples of another one. The ends
  /// are there.
  void compute(Eigen::Index stride, Eigen::Index except = kRecallWaypoints);

  /// dof x kRecallWaypoints: the ends, and what was computed; not finite where the projection onto
  /// the constraint failed.
  const Eigen::MatrixXd& waypoints() const noexcept { return moved_; }
  planning::RegionConstraint* constraint() const noexcept { return target_.constraint; }

 private:
  /// Moves the joints of a waypoint. \return the pose of the hand to be reached there; nothing: it
  /// is there.
  std::optional<Eigen::Isometry3d> move(Eigen::Index waypoint);
  void put_hands(std::span<const Eigen::Index> waypoints,
                 std::span<const Eigen::Isometry3d> wanted);
  void project(Eigen::Index waypoint);

  const Warper& warper_;
  const WarpedPath& path_;
  WarpTarget target_;  // not const: moved with the warp
  const WarpBlend& blend_;
  const std::optional<Eigen::Isometry3d> T_new_old_;
  Eigen::Isometry3d T_start_, T_goal_;  // motions of the ends, in the base link
  Eigen::VectorXd turns_, by_start_, by_goal_;
  bool is_same_start_ = false, is_far_start_ = false;
  Eigen::MatrixXd moved_;
};

}  // namespace kinship::recall
