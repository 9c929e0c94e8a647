#pragma once

#include <Eigen/Core>
#include <vector>

#include "proto/types/limits.hpp"
#include "robots/planning/joint_turns.hpp"
#include "robots/planning/region_constraint.hpp"

/// For this library's sources only.
namespace kinship::planning {

inline constexpr int kMaxIterations = 12;                                     ///< of a projection
inline constexpr double kAimed = 0.5 * RegionConstraint::kWaypointTolerance;  ///< it ends there
inline constexpr double kSquaredDamping =
    1e-4;  ///< of singular values about 1 (m or rad per joint unit)
inline constexpr double kMinCosine =
    1e-3;  ///< of the pitch: its derivative is unbounded at 90 degrees

/// A rotation outside its bounds.
struct AngleExcess {
  Eigen::Vector3d beyond;  ///< roll, pitch, yaw, rad; 0 within the bounds
  bool is_flipped;         ///< whether the rotation counts as (roll + pi, pi - pitch, yaw + pi)
};

/// The excess of a rotation in the one of its two representations that is less outside, angles
/// modulo a full turn.
/// \param angles  roll, pitch, yaw, rad; arbitrary for unbounded ones.
/// \param bounds  2 x 3: lower, upper; both infinite, or less than a turn apart.
AngleExcess angle_excess(const Eigen::Vector3d& angles,
                         const Eigen::Ref<const Eigen::Matrix<double, 2, 3>>& bounds);

/// Roll and pitch of the frame at the end of a chain, in a region that bounds only these. They
/// depend only on the third row of the frame's rotation; a row is swept along the chain at a
/// fraction of the cost of a pose, and their derivative back as two columns. Immutable.
class RegionTilt {
 public:
  /// A joint and its frame; its axis is the z-axis of the frame.
  struct Joint {
    Eigen::Matrix3d R;  ///< in the previous frame, after that frame's joint has turned
    bool slides;
  };

  /// \param joints  at least one, at most kMaxDof, the first in the region's frame.
  /// \param R_end   of the frame at the end, after the last joint.
  /// \param bounds  2 x 2: of roll and pitch, rad, as angle_excess() takes them.
  /// \param margin  distance inside the bounds at which a projection aims, rad.
  RegionTilt(const std::vector<Joint>& joints, const Eigen::Matrix3d& R_end,
             const Eigen::Matrix2d& bounds, const Eigen::Array2d& margin);

  /// Roll and pitch beyond the bounds, rad.
  Eigen::Array2d excess(const Eigen::VectorXd& q) const;

  /// As RegionConstraint::project. \param bounds  2 x dof: of q.
  bool project(const Eigen::Matrix2Xd& bounds, Eigen::VectorXd& q) const;

 private:
  static constexpr std::size_t kRoom = kMaxDof;

  /// The row along the chain.
  struct Sweep {
    JointTurns turns;
    double x[kRoom], y[kRoom];  // after each joint has turned
    Eigen::RowVector3d end;
  };

  /// The range of an angle as a cone, to test the angle without computing it.
  struct Cone {
    double sine, cosine;  // of its middle
    double slope;         // of its sides; not a number: no cone
  };

  struct Excess {
    Eigen::Array2d beyond;
    bool is_flipped;
  };

  static Cone cone_of(double lower, double upper);
  void sweep(const Eigen::VectorXd& q, Sweep& along) const;
  Excess excess(const Eigen::RowVector3d& end) const;
  /// A step of damped least squares from q.
  void improve(const Sweep& along, const Excess& outside, Eigen::VectorXd& q) const;

  Eigen::Index dof_;
  // Between two joints' axes a rotation is a turn about z, one about x, one about z. Those about z
  // are added to the joints' own.
  alignas(16) double offset_[kRoom] = {}, turns_[kRoom] = {};  // angle: offset + turns * q
  double tilt_sine_[kRoom], tilt_cosine_[kRoom];               // about x, after each joint
  Eigen::RowVector3d first_;                                   // the row before the first joint
  Eigen::Matrix3d R_end_;
  Eigen::Matrix<double, 2, 3> bounds_;  // of roll, pitch, and yaw, which has none
  Eigen::Array2d margin_;
  Cone roll_, pitch_;
};

}  // namespace kinship::planning
