#pragma once

#include <Eigen/Core>
#include <vector>

#include "proto/types/mixture.hpp"
#include "server/density/weighted_points.hpp"

namespace kinship::density {

/// What the points say about each component: sums over the points, weighted by point weight and
/// responsibility. Relative to the points' offset.
struct Moments {
  Eigen::VectorXd masses;  ///< K
  Eigen::MatrixXd sums;    ///< d x K, of points
  Eigen::MatrixXd
      squares;  ///< d (d + 1) / 2 x K, of products of two joints, (0,0), (0,1) ... (1,1) ...
};

struct Expectation {
  Moments moments;
  double mean_log_likelihood = 0;  ///< weighted, per point, nats
};

/// E-step: the moments under the responsibilities of a mixture, block by block.
/// \throws Failure(Internal) if a covariance is not positive definite.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.23 and 9.28.
Expectation expectation(const Mixture& mixture, const WeightedPoints& points);

/// The moments if each point belongs to one component entirely.
/// \param component_of_point  n indices below `components`.
Moments moments_of_clusters(const WeightedPoints& points,
                            const std::vector<Eigen::Index>& component_of_point,
                            Eigen::Index components);

/// M-step: the mixture that fits the moments best, with `covariance_floor` added to each variance.
/// Components whose mass is below d + 1 average points have lost their data and are left out; the
/// heaviest stays in any case.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.24 to 9.27.
Mixture maximisation(const Moments& moments, double covariance_floor);

}  // namespace kinship::density
