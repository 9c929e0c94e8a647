#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "robots/inverse/axis.hpp"
#include "robots/inverse/subproblems.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

/// Up to two values of a planar arm's free joints.
struct PlanarBranches {
  std::array<std::array<double, 3>, 2> angles{};
  int count = 0;
  bool outside = false;  ///< whether one was left out for a joint outside its window
};

/// The free joints of a planar arm, and the values of the others.
struct PlanarTask {
  const std::vector<int>& free;            ///< ascending, two or three
  const std::vector<TurnWindow>& windows;  ///< of the free joints
  const double* values;                    ///< of all joints, rad; values of free ones are ignored
  double slack = 0;                        ///< see SixJointTask
};

/// An arm whose joints all turn about one direction, which is x, y or z of its base: a planar arm
/// in closed form. Three joints are free if the direction of the transfer frame matters, else two.
class PlanarForm {
 public:
  /// \return nothing if the joints are not parallel (within kNearStructure), the task axes are not
  ///         a place in the plane with or without a direction, or there are too few joints.
  static std::optional<PlanarForm> of(const AxisChain& axes, const kinematics::Chain& chain);

  int free_joints() const { return turn_matters_ ? 3 : 2; }
  double deviation() const { return deviation_; }  ///< of the directions of the axes: sine

  /// \param T  of the transfer frame in the base link, in units of the arm's size.
  PlanarBranches solve(const PlanarTask& task, const Displacement& T) const;

 private:
  using Point = std::complex<double>;
  PlanarForm() = default;

  Point in_plane(const Eigen::Vector3d& p) const { return {x_.dot(p), y_.dot(p)}; }
  Turn turn_of(const Eigen::Matrix3d& R) const;

  Eigen::Vector3d normal_, x_, y_;
  std::vector<Point> joints_;
  std::vector<double> signs_;  ///< +1: turns about the normal, -1: the other way
  Point transfer_;
  Eigen::Matrix3d R_transfer_base_;  ///< with every joint at 0
  bool turn_matters_ = true;
  double deviation_ = 0;
};

}  // namespace kinship::inverse
