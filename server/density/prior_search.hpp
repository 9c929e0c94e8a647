#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/mixture.hpp"
#include "server/density/block_points.hpp"
#include "server/density/em_run.hpp"

namespace kinship::density {

/// Points that are fitted, and points of other paths that score them.
struct PriorFold {
  BlockPoints training;
  Eigen::Index components = 0;  ///< that the training points may have
  double share = 1;             ///< weight of these / of all points; scales the mass of a prior
  BlockPoints held_out;
};

struct PriorChoice {
  double prior = 0;
  /// Score of the first fold, nats; none if no prior could be computed, then `prior` is 0.
  std::optional<double> score_of_first = {};
};

/// The scatter of `prior` points distributed like those of the clusters: prior times the mean
/// covariance of the components, weighted by their weights.
/// \return d x d, or empty for a prior of 0.
Eigen::MatrixXd prior_scatter(const Mixture& clusters, double prior);

/// Chooses the prior by mean score over the folds: from a middle one to weaker ones as long as
/// scores rise, or to stronger ones if they do not; each with a few iterations of EM from the same
/// k-means clusters.
/// \param folds        at least one.
/// \param log_uniform  the score's background, see mean_log_density.
PriorChoice choose_prior(const std::vector<PriorFold>& folds, double log_uniform,
                         std::uint64_t seed, const EmOptions& options);

/// The prior if no path can be held out.
inline constexpr double kPriorOfOnePath = 40;

}  // namespace kinship::density
