#pragma once

#include <optional>
#include <vector>

#include "robots/inverse/axis.hpp"
#include "robots/inverse/six_joints.hpp"

namespace kinship::inverse {

/// Largest deviation from a structure (share of the arm's size; sine) of axes that have it exactly,
/// apart from rounding in model files and arithmetic.
inline constexpr double kExactStructure = 1e-9;
/// Largest deviation of axes that nearly have it, as in a calibrated robot, whose deviations add up
/// along the chain. Its branches need a polish.
inline constexpr double kNearStructure = 0.03;

/// A structure with which a chain of turning joints is solvable in closed form: six joints obey a
/// rule once the others are locked, at any values.
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

/// Writes the free axes into a task, and removes the displacements of the locked ones from its
/// wanted displacement.
/// \param locks   ascending, size axes.size() - 6.
/// \param values  one per lock: rad, or lengths in units of the arm's size.
void lock(const std::vector<Axis>& axes, const std::vector<int>& locks, const double* values,
          SixJointTask& task);

/// The common direction of parallel turning joints, and their deviation from it (sine).
struct CommonDirection {
  Eigen::Vector3d direction;
  double deviation = 0;
};

/// \return nothing unless all joints turn about axes that are parallel within kNearStructure.
std::optional<CommonDirection> common_direction(const AxisChain& chain);

}  // namespace kinship::inverse
