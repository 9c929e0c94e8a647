#pragma once

#include <Eigen/Core>
#include <optional>
#include <random>
#include <vector>

#include "proto/mixture/sampler.hpp"
#include "proto/types/distribution.hpp"

namespace kinship::mixture {

/// Draws configurations of a distribution: its mixture truncated to the limits, except for
/// continuous joints, whose samples are wrapped into [-pi, pi] instead. Immutable after
/// construction: may be shared between threads with a generator each.
class DistributionSampler {
 public:
  /// \param distribution  with a mixture.
  /// \throws see `Sampler`.
  explicit DistributionSampler(const Distribution& distribution);

  Eigen::Index dimension() const noexcept { return sampler_.dimension(); }

  /// See `Sampler::sample`.
  std::optional<Eigen::VectorXd> sample(std::mt19937_64& generator) const;
  Eigen::MatrixXd sample(std::mt19937_64& generator, Eigen::Index count) const;

 private:
  std::vector<Eigen::Index> continuous_;  // joints
  Sampler sampler_;
};

}  // namespace kinship::mixture
