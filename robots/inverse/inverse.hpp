#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "robots/kinematics/chain.hpp"

namespace kinship::inverse {

struct InverseOptions {
  int max_solutions = 8;      ///< L; 0: all found, at most 1000
  double min_distance = 0.2;  ///< d: Euclidean, 1 m = 1 rad; wrapped for continuous joints
  std::uint64_t seed = 0;     ///< equal seed and pose: equal solutions
  /// Whether to go on if the first starts found nothing, which costs ten times as much and seldom
  /// helps. It keeps all solutions that are found without it.
  bool exhaustive = true;
};

/// Why a set of solutions is empty.
enum class NoSolution { None, OutOfReach, Limits, NotConverged };

struct InverseSolutions {
  Eigen::MatrixXd configurations;        ///< dof x n, n >= 0
  NoSolution reason = NoSolution::None;  ///< None if n > 0
};

/// Distinct configurations, within joint limits, that put the tip link at a pose.
/// Each is verified by forward kinematics of the chain within 1e-6 m and 1e-6 rad in the task
/// axes that matter. A random choice among more; of +-2 pi copies the one nearest mid-range.
/// \param T_base_tip  pose of the tip link in the base link, m.
/// \return            possibly empty, with the reason: an unreachable pose is an answer, no error.
InverseSolutions inverse(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip,
                         const InverseOptions& options = {});

/// Name of the solver that `inverse` uses for a chain, e.g. "multi-start Levenberg-Marquardt".
std::string solver_name(const kinematics::Chain& chain);

/// Version of this solver; part of a distribution's key. Raised when solutions change.
inline constexpr int kInverseVersion = 6;

}  // namespace kinship::inverse
