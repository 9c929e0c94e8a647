#pragma once

#include <cstdint>
#include <vector>

#include "proto/types/distribution.hpp"
#include "proto/types/mixture.hpp"
#include "server/density/block_points.hpp"
#include "server/density/em_run.hpp"

namespace kinship::density {

/// The search for the number of components, from too many down.
struct ComponentSearch {
  std::vector<ComponentScore> curve;  ///< falling number of components
  Mixture best;                       ///< of the highest score, fitted to the training points
  double best_score = 0;
};

/// The share of the uniform distribution in a score: one point far away must not decide it.
inline constexpr double kBackgroundShare = 0.01;

/// Fits many components, then merges them down step by step, with EM in between, and scores each
/// step on the held-out points. Ends early where scores are low or merging fails.
/// \param start  of the components to begin with.
/// \param log_uniform  logarithm of the density of the uniform distribution.
ComponentSearch prune_components(Mixture start, const BlockPoints& training,
                                 const BlockPoints& held_out, double log_uniform,
                                 const EmOptions& options);

}  // namespace kinship::density
