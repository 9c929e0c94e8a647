#pragma once

#include <Eigen/Core>
#include <vector>

#include "proto/types/mixture.hpp"

namespace kinship::mixture {

/// The components of a mixture, factored once for many evaluations. Immutable: may be shared
/// between threads.
class ComponentDensities {
 public:
  /// \throws Failure(Internal) if a covariance is not positive definite.
  explicit ComponentDensities(const Mixture& mixture);

  Eigen::Index size() const noexcept { return means_.cols(); }       ///< number of components K
  Eigen::Index dimension() const noexcept { return means_.rows(); }  ///< d

  /// log(weight of k) + log N(configuration | mean of k, covariance of k).
  /// \param configurations  d x N. The result takes 8 N K bytes: evaluate in blocks.
  /// \return                N x K, in nats; finite for every finite configuration unless the
  ///                        component's weight is 0 (then minus infinity).
  /// \throws std::invalid_argument if configurations.rows() != dimension().
  /// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 2.43.
  Eigen::MatrixXd weighted_log_densities(
      const Eigen::Ref<const Eigen::MatrixXd>& configurations) const;

 private:
  Eigen::MatrixXd means_;  // d x K
  std::vector<Eigen::MatrixXd>
      whitenings_;              // inverses of the lower Cholesky factors, d x d; K or one
  Eigen::VectorXd log_scales_;  // log weight - log sqrt((2 pi)^d det covariance)
};

/// log of the sum of exp over each row, computed so that it neither over- nor underflows.
Eigen::VectorXd log_sum_exp_of_rows(const Eigen::Ref<const Eigen::MatrixXd>& terms);

}  // namespace kinship::mixture
