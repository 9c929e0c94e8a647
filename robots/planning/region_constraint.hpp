#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/task_space_region.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/region_lanes.hpp"

namespace kinship::planning {

class RegionTilt;

/// Carrying upright with a hand that points down: the transfer frame anywhere, its approach
/// direction within `tilt_rad` of straight down (roll and pitch each).
TaskSpaceRegion upright_region(double tilt_rad);

/// A task space region as a constraint on the configurations of one robot at one place. Holds its
/// own copy of the kinematics; allocates nothing after construction. Counts its projections, so
/// not shared between threads.
/// Source: Berenson, Srinivasa and Kuffner, Task Space Regions (IJRR 2011), section 4.
class RegionConstraint {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 =
      Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, static_cast<int>(kMaxDof)>;

  /// Largest distance outside the region of a constrained path's waypoints, and of the lines
  /// between them; the norm of `excess`, 1 m = 1 rad.
  static constexpr double kWaypointTolerance = 1e-3, kBetweenTolerance = 5e-3;

  /// \param T_task_base  pose of the chain's base link in the task frame.
  /// \param bounds       2 x dof: bounds of a projection, joint units (see planning_bounds).
  /// \throws std::invalid_argument if the region has a fault or the bounds do not fit the chain.
  RegionConstraint(const kinematics::Chain& chain, const TaskSpaceRegion& region,
                   const Eigen::Isometry3d& T_task_base, const Eigen::Matrix2Xd& bounds);

  /// Excess of the transfer frame: displacement beyond the region's bounds in x, y, z (m), roll,
  /// pitch, yaw (rad); 0 within the bounds. Angles count modulo a full turn, and of the two
  /// representations of a rotation the one that is less outside.
  Vector6 excess(const Eigen::VectorXd& q) const;

  /// Derivative of the displacement, and so of the excess where that is not zero: 6 x dof, per
  /// joint unit. Bounded near a pitch of 90 degrees, where the true one is not.
  Matrix6 derivative(const Eigen::VectorXd& q) const;

  double distance(const Eigen::VectorXd& q) const { return excess(q).norm(); }  ///< 1 m = 1 rad
  bool holds(const Eigen::VectorXd& q) const { return distance(q) <= kWaypointTolerance; }

  /// Moves q into the region (to half the tolerance of waypoints) by damped least squares over the
  /// coordinates that are outside, aiming a little inside if there is room, so that few iterations
  /// suffice. Never leaves the bounds. Counts one projection.
  /// \return false if it did not converge; q is then anywhere within the bounds.
  bool project(Eigen::VectorXd& q);

  /// Some configurations side by side, as project() but to single precision and with fewer
  /// iterations: enough for those that are near the region. Each column as if it were alone, alike
  /// on all machines. Counts nothing.
  /// \param qs  dof x n, n <= kSideBySide; columns that did not arrive are anywhere in the bounds.
  /// \return    a bit for each that arrived.
  unsigned project_together(Eigen::Ref<Eigen::MatrixXd> qs) const;

  /// \param qs  dof x n, n <= kSideBySide.
  /// \return    a bit for each that is at most so far outside the region, to single precision.
  unsigned hold_together(const Eigen::Ref<const Eigen::MatrixXd>& qs, double distance) const;

  const LaneRegion& lanes() const noexcept { return lanes_; }  ///< as the kernels take it

  std::uint64_t projections() const noexcept { return projections_; }
  /// For a caller that projects ahead and counts only the projections it needed.
  void set_projections(std::uint64_t projections) noexcept { projections_ = projections; }

 private:
  static constexpr int kMaxJoints = static_cast<int>(kMaxDof);
  static_assert(kLaneJoints >= kMaxJoints);
  using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxJoints>;

  /// A joint whose axis is the z-axis of its frame.
  struct Segment {
    Eigen::Matrix3d R;  // from the frame before it
    Eigen::Vector3d p;
    bool prismatic = false;
  };

  /// Poses along the chain, in the region's frame.
  struct Sweep {
    Columns origins, axes;  // of the joints
    Eigen::Matrix3d R;      // of the transfer frame, less T_region_end
    Eigen::Vector3d p;
  };

  void fill_lanes();
  /// Not null if only roll and pitch are bounded.
  std::shared_ptr<const RegionTilt> tilt() const;
  void sweep(const Eigen::VectorXd& q, Sweep& along) const;
  /// \param flipped  whether the rotation counts as (roll + pi, pi - pitch, yaw + pi).
  Vector6 excess(const Sweep& along, bool& flipped) const;
  /// Derivative of the displacement: 6 x dof.
  void derive(const Sweep& along, bool flipped, Matrix6& derivative) const;

  std::vector<Segment> segments_;
  Eigen::Matrix3d R_end_;  // after the last joint
  Eigen::Vector3d p_end_;
  Eigen::Matrix<double, 2, 6> region_bounds_;
  Vector6 margin_;  // how far inside its bounds a coordinate is aimed at
  Eigen::Matrix2Xd bounds_;
  LaneRegion lanes_{};
  std::shared_ptr<const RegionTilt> tilt_;  // shared by copies; immutable
  std::uint64_t projections_ = 0;
};

/// Goes along a region in steps towards a target that may lie outside it. Not shared between
/// threads.
class ConstrainedStepper {
 public:
  /// \param step        longest step, joint units.
  /// \param constraint  must outlive this; counts the projections.
  ConstrainedStepper(double step, RegionConstraint& constraint);

  /// The next configuration on the way: within the waypoint tolerance of the region and nearer to
  /// the target than `q`, at most a step away, the line between within the other tolerance. Where
  /// the region bends too much for a full step, a shorter one. Not checked for collisions.
  /// \param q  holds the constraint.
  /// \return   false if no progress is possible.
  bool advance(const Eigen::VectorXd& q, const Eigen::VectorXd& target, Eigen::VectorXd& next);

  /// As advance() from some configurations towards their targets, side by side and without shorter
  /// steps. Counts a projection for each.
  /// \param qs, targets  dof x n, n <= kSideBySide. \param next  dof x n, out.
  /// \return a bit for each that made its step; for the others advance() may know a shorter one.
  unsigned advance_together(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                            const Eigen::Ref<const Eigen::MatrixXd>& targets,
                            Eigen::Ref<Eigen::MatrixXd> next);

  /// Some steps towards a target at once, as a repeated advance() may make them: the configurations
  /// of a straight line, projected side by side. Counts a projection for each step.
  /// \param steps  dof x kSideBySide, out. \return how many; 0: advance() may know a shorter one.
  Eigen::Index advance_ahead(const Eigen::VectorXd& q, const Eigen::VectorXd& target,
                             Eigen::Ref<Eigen::MatrixXd> steps);

  /// All configurations from `from` to `to`, both of which hold the constraint, in such steps.
  /// Not checked for collisions.
  /// \return dof x n, n >= 1; empty if the way gets stuck.
  std::optional<Eigen::MatrixXd> way(const Eigen::VectorXd& from, const Eigen::VectorXd& to);

  /// All configurations along waypoints, dof x n, n >= 2, each of which holds the constraint.
  /// \return as way().
  std::optional<Eigen::MatrixXd> way_through(const Eigen::MatrixXd& waypoints);

  /// Whether two configurations that hold the constraint are one step apart.
  bool joins(const Eigen::VectorXd& q, const Eigen::VectorXd& other);

 private:
  bool within_tolerance_between(const Eigen::VectorXd& q, const Eigen::VectorXd& other);

  /// Whether a projected configuration is a step on the way. \param stride  before its projection.
  bool is_step(const Eigen::Ref<const Eigen::VectorXd>& q,
               const Eigen::Ref<const Eigen::VectorXd>& next,
               const Eigen::Ref<const Eigen::VectorXd>& target, double stride) const;

  double step_;
  RegionConstraint& constraint_;
  // Kept, so that a step allocates nothing.
  Eigen::VectorXd middle_;
  Eigen::MatrixXd middles_;
};

}  // namespace kinship::planning
