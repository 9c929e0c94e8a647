#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <stop_token>
#include <utility>
#include <vector>

#include "proto/types/profile.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/inverse/solver.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/filters.hpp"
#include "server/transfer/path_poses.hpp"

namespace kinship::transfer {

/// Random solutions of inverse kinematics for one pose that pass the filters.
struct RandomSolutions {
  Eigen::MatrixXd configurations;                          ///< dof x n, n >= 0
  inverse::NoSolution reason = inverse::NoSolution::None;  ///< why inverse kinematics found none
  bool colliding = false;  ///< it found some, but the filters rejected all
};

/// Up to parameters.max_solutions configurations at least parameters.min_distance apart, a random
/// choice among those that the filters keep. If they leave some out, others are searched for once.
/// \param T_base_transfer  pose of the transfer frame in the target's base link.
/// \param exhaustive          InverseOptions::exhaustive: whether to go on if the first starts
///                            found none.
RandomSolutions random_solutions(const inverse::Solver& target,
                                 const Eigen::Isometry3d& T_base_transfer,
                                 const TransferParameters& parameters, std::uint64_t seed,
                                 CountedFilters& filters, bool exhaustive = true);

/// Options of a search.
struct Search {
  Search(std::uint64_t the_seed, std::stop_token the_stop = {})  // NOLINT: a seed is a search
      : seed(the_seed), stop(std::move(the_stop)) {}

  std::uint64_t seed;
  std::stop_token stop;  ///< checked before each pose
};

/// Random solutions of the poses of a path that no track covers.
///
/// A pose without a solution costs far more than one with some, and such poses stand side by side.
/// The exhaustive search is therefore kept for poses with an open outcome: a pose without a
/// solution by the short search gets it if a neighbouring pose is reached, by a track or a solution
/// (that filters may have left out), or if it ends the path. So every row of poses without a
/// solution ends in two that were searched exhaustively, and the results of each of the others
/// depend on the seed and that pose only.
///
/// \param covered  one per pose.
/// \return         one per pose; without configurations and reason where `covered`.
/// \throws Stopped.
std::vector<RandomSolutions> solve_uncovered(const ArmPair& pair, const PathPoses& poses,
                                             const std::vector<bool>& covered,
                                             const TransferParameters& parameters,
                                             const Search& search, CountedFilters& filters);

}  // namespace kinship::transfer
