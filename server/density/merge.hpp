#pragma once

#include <Eigen/Core>
#include <stop_token>

#include "proto/types/mixture.hpp"

namespace kinship::density {

/// Merges pairs of components until at most `components` are left, each time the pair whose merging
/// costs least by an upper bound of the Kullback-Leibler divergence; the total mean and covariance
/// stay the same.
/// \param components  at least 1.
/// \throws Failure(Internal) if a covariance, or by rounding that of each pair, is not definite;
///         Stopped.
/// Source: Runnalls, Kullback-Leibler approach to Gaussian mixture reduction, IEEE Transactions on
/// Aerospace and Electronic Systems (2007), eq. 16 and 21.
Mixture merged(const Mixture& mixture, Eigen::Index components, const std::stop_token& stop = {});

}  // namespace kinship::density
