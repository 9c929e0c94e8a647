#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "proto/types/mixture.hpp"

namespace kinship::mixture {

/// Draws configurations from a mixture truncated to joint limits, by rejection of whole draws
/// (component too, so that the truncated mixture is what is sampled).
/// Immutable after construction: may be shared between threads with a generator each.
class Sampler {
 public:
  /// \param limits  2 x d: lower, upper, joint units.
  /// \throws std::invalid_argument if shapes differ or a lower limit exceeds its upper.
  /// \throws Failure(Internal) if a covariance is not positive definite.
  Sampler(const Mixture& mixture, Eigen::Matrix2Xd limits);

  Eigen::Index dimension() const noexcept { return limits_.cols(); }

  /// One configuration inside the limits; empty if none came out of `kMaxDraws` draws, which
  /// says that the mixture lies outside the limits.
  std::optional<Eigen::VectorXd> sample(std::mt19937_64& generator) const;

  static constexpr int kMaxDraws = 1000;

 private:
  Eigen::Index draw_component(std::mt19937_64& generator) const;

  std::vector<double> cumulative_weights_;
  Eigen::MatrixXd means_;    // d x K
  Eigen::MatrixXd factors_;  // d x d K, or d x d if shared: column k d + i is row i of k's
  Eigen::Matrix2Xd limits_;
};

}  // namespace kinship::mixture
