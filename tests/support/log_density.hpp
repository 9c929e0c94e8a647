#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <vector>

#include "proto/mixture/cholesky.hpp"
#include "proto/types/mixture.hpp"

namespace kinship::test {

/// Natural logarithm of the mixture's density at each configuration, in the log domain: what the
/// kernels of server/density compute block by block, as the formula has it.
/// \param configurations  d x N.
/// \return                N, in nats.
/// \throws Failure(Internal) if a covariance is not positive definite.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.7 and 2.43.
inline Eigen::VectorXd log_density(const Mixture& mixture,
                                   const Eigen::Ref<const Eigen::MatrixXd>& configurations) {
  const std::vector<Eigen::MatrixXd> factors = mixture::cholesky_factors(mixture);
  const double log_unit =
      0.5 * static_cast<double>(mixture.dimension()) * std::log(2 * std::numbers::pi);
  Eigen::MatrixXd terms(configurations.cols(), mixture.size());
  for (Eigen::Index k = 0; k < mixture.size(); ++k) {
    const Eigen::MatrixXd& factor = factors[mixture.covariance_index(k)];
    Eigen::MatrixXd whitened = configurations.colwise() - mixture.means().col(k);
    factor.triangularView<Eigen::Lower>().solveInPlace(whitened);
    const double log_scale =
        std::log(mixture.weights()[k]) - factor.diagonal().array().log().sum() - log_unit;
    terms.col(k) = log_scale - 0.5 * whitened.colwise().squaredNorm().transpose().array();
  }
  const Eigen::VectorXd largest = terms.rowwise().maxCoeff();
  return largest.array() + (terms.colwise() - largest).array().exp().rowwise().sum().log();
}

}  // namespace kinship::test
