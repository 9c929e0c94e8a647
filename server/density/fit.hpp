#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "proto/types/mixture.hpp"
#include "proto/types/profile.hpp"
#include "proto/types/result.hpp"
#include "server/density/expectation_maximisation.hpp"

namespace kinship::density {

struct FitOptions {
  int components = 50;             ///< K; lowered to what the configurations can carry
  double covariance_floor = 1e-4;  ///< added to each variance, squared joint units
  /// d, instead of covariance_floor, where joints have different units; empty: all the same.
  Eigen::VectorXd floors_of_joints = {};
  int max_iterations = 50;
  double tolerance = 1e-3;  ///< stop when the mean log-likelihood gains less, nats
  std::uint64_t seed = 0;
  Computation computation = {};
};

struct FitSummary {
  Mixture mixture;
  /// Weighted mean per configuration after each iteration over all of them, nats; the last is that
  /// of `mixture`.
  std::vector<double> log_likelihoods;
};

/// Fits a Gaussian mixture with full covariances: k-means++ start, Lloyd iterations, EM.
/// K is lowered so that each component can have 2 (d + 1) distinct configurations, and components
/// that lose their data on the way are left out. With more than four times kSamplePoints or
/// kSamplePointsPerComponent K configurations EM sees such a sample first, and then all of them at
/// most kFullPasses times. Deterministic: equal input, equal bytes, whatever the number of threads.
/// Neither the order of the configurations nor repetition instead of weight matters beyond
/// rounding.
/// \param configurations  d x N, at most 1e6 in magnitude, joint units.
/// \param weights         N, non-negative, positive sum.
/// \return the mixture, or InvalidInput if there are fewer than d + 1 distinct configurations of
///         positive weight, a number is not finite or too large, no weight is positive, or the
///         configurations are degenerate and the covariance floor too small to make up for it.
/// \throws std::invalid_argument if sizes differ or an option is outside its range.
/// Source: Bishop, Pattern Recognition and Machine Learning (2006), section 9.2; Arthur and
/// Vassilvitskii, k-means++ (2007).
Result<FitSummary> fit_mixture(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const FitOptions& options);

inline constexpr Eigen::Index kSamplePoints = 20'000;
inline constexpr Eigen::Index kSamplePointsPerComponent = 400;
inline constexpr int kFullPasses = 6;

/// Version of this code; part of a distribution's key. Raised when its output changes.
inline constexpr int kDensityVersion = 2;

}  // namespace kinship::density
