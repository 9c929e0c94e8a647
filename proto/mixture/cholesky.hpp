#pragma once

#include <Eigen/Core>
#include <vector>

#include "proto/types/mixture.hpp"

namespace kinship::mixture {

/// The lower Cholesky factor of each of covariances(), d x d with zeros above the diagonal; that of
/// component k is at covariance_index(k).
/// \throws Failure(Internal) that names the first component whose covariance is not positive
///         definite.
std::vector<Eigen::MatrixXd> cholesky_factors(const Mixture& mixture);

}  // namespace kinship::mixture
