#pragma once

#include <Eigen/Core>
#include <stop_token>

#include "proto/types/mixture.hpp"
#include "server/density/block_points.hpp"
#include "server/density/instruction_set.hpp"
#include "server/density/simd_kernels.hpp"

namespace kinship::density {

/// How sums over points are computed. Options change results by rounding only, the number of
/// threads not at all.
struct Computation {
  int threads = 1;
  bool prune = true;  ///< leave out terms below the precision of the result
  const SimdKernels* kernels = &widest_simd_kernels();
  std::stop_token stop = {};  ///< checked in each block of points: throws Stopped
};

/// Moments of each component: sums over the points, weighted by point weight and responsibility,
/// relative to the points' offset. Column k holds those of 1 (the mass), of q_0 ... q_{d-1}, and of
/// q_i q_j, (0,0), (0,1) ... (1,1) ...
struct Moments {
  Eigen::MatrixXd sums;  ///< (d + 1) (d + 2) / 2 x K
  int dimension = 0;

  Eigen::Index components() const noexcept { return sums.cols(); }
  double mass(Eigen::Index k) const { return sums(0, k); }
};

struct Expectation {
  Moments moments;
  double mean_log_likelihood = 0;  ///< weighted, per point, nats
};

/// E-step: the moments under the responsibilities of a mixture.
///
/// Pruned, a component is left out of a block whose box bounds say that it has at most e^-42 of the
/// density of another one at each point there: of a sum it would have been 6e-19.
/// \throws Failure(Internal) if a covariance is not positive definite.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.23 and 9.28.
Expectation expectation(const Mixture& mixture, const BlockPoints& points,
                        const Computation& computation);

/// The weighted mean over the points of log((1 - background_share) p + background_share *
/// exp(log_background)), where p is the mixture's density: a score that a few points far away
/// cannot decide.
double mean_log_density(const Mixture& mixture, const BlockPoints& points, double background_share,
                        double log_background, const Computation& computation);

/// The logarithm of the density at each point, N, in block order.
Eigen::VectorXd log_densities(const Mixture& mixture, const BlockPoints& points,
                              const Computation& computation);

/// M-step: the mixture that fits the moments best, with the floor of its joint added to each
/// variance, or, with a prior, the one that is likeliest: (W + prior_scatter) / mass is the
/// covariance of a component of scatter W, the wider the less mass it has. Components whose mass is
/// below d + 1 average points have lost their data and are left out; the heaviest stays in any
/// case.
/// \param offset            d: of the points.
/// \param floors            d, squared joint units.
/// \param prior_scatter     d x d, squared joint units times points; empty: no prior.
/// \param least_mass_share  of d + 1 points, where each point stands for several.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.24 to 9.27; with a prior
/// Fraley and Raftery, Bayesian regularization for normal mixture estimation (2007), section 3.2,
/// of whose degrees of freedom as many are taken as leave the mass alone in the denominator.
Mixture maximisation(const Moments& moments, const Eigen::VectorXd& offset,
                     const Eigen::VectorXd& floors, const Eigen::MatrixXd& prior_scatter = {},
                     double least_mass_share = 1);

}  // namespace kinship::density
