#include "client/python/sampled_distribution.hpp"

#include <random>
#include <string>

#include "proto/types/failure.hpp"

namespace kinship::python {

const Mixture& SampledDistribution::mixture() const {
  if (!value_->mixture)
    throw Failure(ErrorCode::NotFound,
                  "distribution " + value_->id.short_hex() + " has no mixture: " + value_->reason);
  return *value_->mixture;
}

const mixture::DistributionSampler& SampledDistribution::sampler() const {
  static_cast<void>(mixture());
  const std::scoped_lock lock(mutex_);
  if (!sampler_)
    sampler_.emplace(*value_);
  return *sampler_;
}

Eigen::MatrixXd SampledDistribution::sample(std::uint64_t seed, Eigen::Index count) const {
  if (count < 0)
    throw Failure(ErrorCode::InvalidInput, "sample: n is " + std::to_string(count));
  std::mt19937_64 generator(seed);
  Eigen::MatrixXd samples = sampler().sample(generator, count);
  if (samples.cols() < count)
    throw Failure(ErrorCode::Internal, "distribution " + value_->id.short_hex() +
                                           ": the mixture lies outside the joint limits");
  return samples;
}

}  // namespace kinship::python
