#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "proto/types/profile.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/inverse/solver.hpp"
#include "server/transfer/filters.hpp"

namespace kinship::transfer {

/// What random inverse kinematics and the filters leave of one pose.
struct RandomSolutions {
  Eigen::MatrixXd configurations;                          ///< dof x n, n >= 0
  inverse::NoSolution reason = inverse::NoSolution::None;  ///< why inverse kinematics found none
  bool colliding = false;  ///< it found some, but the filters left out each
};

/// How long inverse kinematics looks where it has found nothing yet: InverseOptions::patient.
enum class Patience { None, Full };

/// Up to parameters.max_solutions configurations at least parameters.min_distance apart, a random
/// choice among those that the filters keep. Where they leave some out, others are looked for once.
/// \param T_base_transfer  pose of the transfer frame in the target's base link.
/// \param patience         whether to go on where the first starts found nothing.
RandomSolutions random_solutions(const inverse::Solver& target,
                                 const Eigen::Isometry3d& T_base_transfer,
                                 const TransferParameters& parameters, std::uint64_t seed,
                                 CountedFilters& filters, Patience patience = Patience::Full);

}  // namespace kinship::transfer
