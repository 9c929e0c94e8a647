#pragma once

#include <Eigen/Core>

#include "proto/types/distribution.hpp"
#include "proto/types/mixture.hpp"

namespace kinship::mixture {

/// Natural logarithm of the mixture's density at each configuration, in the log domain, so that it
/// is finite even far from every component.
/// \param configurations  d x N, joint units.
/// \return                N, in nats. O(K d^3 + N K d^2).
/// \throws std::invalid_argument if dimensions differ.
/// \throws Failure(Internal) if a covariance is not positive definite.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 9.7 and 2.43.
Eigen::VectorXd log_density(const Mixture& mixture,
                            const Eigen::Ref<const Eigen::MatrixXd>& configurations);

/// The same for a distribution's mixture, not truncated to its limits; continuous joints are turned
/// into the range of its means.
/// \param distribution  with a mixture.
Eigen::VectorXd log_density(const Distribution& distribution,
                            const Eigen::Ref<const Eigen::MatrixXd>& configurations);

}  // namespace kinship::mixture
