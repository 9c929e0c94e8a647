#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "proto/types/mixture.hpp"
#include "server/density/block_points.hpp"
#include "server/density/expectation_maximisation.hpp"

namespace kinship::density {

/// When to stop, and the terms added to variances and covariances.
struct EmOptions {
  Eigen::VectorXd floors;  ///< d, squared joint units
  int max_iterations = 50;
  double tolerance = 1e-2;  ///< mean log-likelihood, nats
  Computation computation = {};
  Eigen::MatrixXd prior_scatter = {};  ///< d x d, see maximisation(); empty: no prior
  double least_mass_share = 1;         ///< see maximisation()
};

struct EmRun {
  Mixture mixture;
  std::vector<double> log_likelihoods;  ///< after each iteration; the last is that of `mixture`
};

/// Points of which a start is made.
inline constexpr Eigen::Index kSamplePoints = 20'000;

/// The mixture of at most `components` k-means clusters of (a sample of) the points, without a
/// prior.
Mixture start_mixture(const BlockPoints& points, Eigen::Index components, std::uint64_t seed,
                      const EmOptions& options);

/// EM until the gain falls below the tolerance.
/// With a prior that is the gain of the posterior: from clusters made without it the likelihood
/// falls.
EmRun run_em(Mixture start, const BlockPoints& points, const EmOptions& options);

/// The same mixture, if the expectation of the start is known and the final likelihood is not
/// needed: two passes less.
Mixture run_em_from(Mixture start, Expectation first, const BlockPoints& points,
                    const EmOptions& options);

}  // namespace kinship::density
