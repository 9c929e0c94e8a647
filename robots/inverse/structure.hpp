#pragma once

#include <optional>
#include <vector>

#include "robots/inverse/axis.hpp"
#include "robots/inverse/six_joints.hpp"

namespace kinship::inverse {

/// Axes that deviate by no more from a structure (share of the arm's size; sine) have it exactly,
/// but for the rounding of model files and arithmetic.
inline constexpr double kExactStructure = 1e-9;
/// Axes that deviate by no more nearly have it: a calibrated robot, whose deviations add up along
/// the chain. Its branches need a polish.
inline constexpr double kNearStructure = 0.03;

/// What makes a chain of turning joints solvable in closed form: six joints that obey a rule once
/// the others are locked, whatever the values they are locked at.
struct SixJointStructure {
  std::vector<int> locks;  ///< joints, ascending, 0 the first; dof - 6 of them
  SixJointRule rule;
  double deviation = 0;    ///< of the axes from the rule: share of the arm's size, or sine
  std::vector<Axis> axes;  ///< of all joints, moved by the deviation so that they obey the rule

  bool exact() const { return deviation <= kExactStructure; }
};

/// Every choice of locks under which the chain has a structure, each with the rule it fits best.
/// None for chains of fewer than six joints, or of more than kMaxLocked beyond six.
std::vector<SixJointStructure> six_joint_structures(const AxisChain& chain);
inline constexpr int kMaxLocked = 2;

/// Writes the axes that are left free while others are locked into a task, and takes from its
/// wanted displacement what the locked ones do.
/// \param locks   ascending, size axes.size() - 6.
/// \param values  one per lock: rad, or lengths in units of the arm's size.
void lock(const std::vector<Axis>& axes, const std::vector<int>& locks, const double* values,
          SixJointTask& task);

/// The common direction of parallel turning joints, and by how much (sine) they deviate from it.
struct CommonDirection {
  Eigen::Vector3d direction;
  double deviation = 0;
};

/// \return nothing unless all joints turn about axes that are parallel but for kNearStructure.
std::optional<CommonDirection> common_direction(const AxisChain& chain);

}  // namespace kinship::inverse
