#pragma once

#include <Eigen/Core>

#include "proto/types/mixture.hpp"

namespace kinship::mixture {

/// Natural logarithm of the mixture's density at each configuration, in the log domain.
/// \param configurations  d x N.
/// \return                N, in nats; finite for every finite configuration.
/// \throws std::invalid_argument if configurations.rows() != mixture.dimension().
/// \throws Failure(Internal) if a covariance is not positive definite.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.7 and 2.43.
Eigen::VectorXd log_density(const Mixture& mixture,
                            const Eigen::Ref<const Eigen::MatrixXd>& configurations);

}  // namespace kinship::mixture
