#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/distribution.hpp"

namespace kinship::python {

/// A distribution and its sampler, made for the first sample. Shared by threads.
class SampledDistribution {
 public:
  /// \param value  not null.
  explicit SampledDistribution(std::shared_ptr<const Distribution> value)
      : value_(std::move(value)) {}

  const std::shared_ptr<const Distribution>& value() const noexcept { return value_; }

  /// \throws Failure(NotFound) if it has none: its fit has failed.
  const Mixture& mixture() const;

  /// \return dof x count; as `mixture::Sampler`, the same for the same seed.
  /// \throws Failure(Internal) if the mixture lies outside the limits.
  Eigen::MatrixXd sample(std::uint64_t seed, Eigen::Index count) const;

 private:
  const mixture::DistributionSampler& sampler() const;

  std::shared_ptr<const Distribution> value_;
  mutable std::mutex mutex_;  // guards what follows until it is made
  mutable std::optional<mixture::DistributionSampler> sampler_;
};

}  // namespace kinship::python
