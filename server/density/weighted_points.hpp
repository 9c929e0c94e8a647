#pragma once

#include <Eigen/Core>

namespace kinship::density {

/// Configurations prepared for a fit: distinct, with positive weights, in lexicographic order,
/// relative to their weighted mean. So neither order, repetition nor a common offset of the
/// configurations matters to what is computed from them.
struct WeightedPoints {
  Eigen::MatrixXd points;   ///< d x n, relative to `offset`, joint units
  Eigen::VectorXd weights;  ///< n, positive, sum n: the average point weighs 1
  Eigen::VectorXd offset;   ///< d, the weighted mean
};

/// \param configurations  d x N, finite.
/// \param weights         N, finite, non-negative, positive sum. Equal configurations add up.
WeightedPoints prepare_points(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                              const Eigen::Ref<const Eigen::VectorXd>& weights);

}  // namespace kinship::density
