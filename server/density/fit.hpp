#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "proto/types/mixture.hpp"
#include "proto/types/profile.hpp"
#include "proto/types/result.hpp"

namespace kinship::density {

struct FitOptions {
  int components = 50;             ///< K; lowered to what the configurations can carry
  double covariance_floor = 1e-4;  ///< added to each variance, squared joint units
  int max_iterations = 50;
  double tolerance = 1e-3;  ///< stop when the mean log-likelihood gains less, nats
  std::uint64_t seed = 0;
};

struct FitSummary {
  Mixture mixture;
  std::vector<double> log_likelihoods;  ///< weighted mean per configuration after each iteration
};

/// Fits a Gaussian mixture with full covariances: k-means++ start, Lloyd iterations, EM.
/// \param configurations  d x N, finite, joint units.
/// \param weights         N, non-negative, positive sum.
/// \return the mixture, or InvalidInput if there are fewer than d + 1 distinct configurations,
///         a number is not finite, or no weight is positive.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), section 9.2; Arthur and
/// Vassilvitskii, k-means++ (2007).
Result<FitSummary> fit_mixture(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const FitOptions& options);

/// Version of this code; part of a distribution's key. Raised when its output changes.
inline constexpr int kDensityVersion = 1;

}  // namespace kinship::density
