#include "proto/mixture/distribution_sampler.hpp"

#include <cstddef>
#include <limits>

#include "proto/types/turn.hpp"

namespace kinship::mixture {
namespace {

std::vector<Eigen::Index> continuous_joints(const Distribution& distribution) {
  std::vector<Eigen::Index> joints;
  for (std::size_t joint = 0; joint < distribution.cuts.size(); ++joint)
    if (distribution.cuts[joint])
      joints.push_back(static_cast<Eigen::Index>(joint));
  return joints;
}

Eigen::Matrix2Xd limits_of_draws(const Distribution& distribution,
                                 const std::vector<Eigen::Index>& continuous) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Eigen::Matrix2Xd limits = distribution.limits;
  for (const Eigen::Index joint : continuous)
    limits.col(joint) << -kNone, kNone;
  return limits;
}

}  // namespace

DistributionSampler::DistributionSampler(const Distribution& distribution)
    : continuous_(continuous_joints(distribution)),
      sampler_(distribution.mixture.value(), limits_of_draws(distribution, continuous_)) {}

std::optional<Eigen::VectorXd> DistributionSampler::sample(std::mt19937_64& generator) const {
  std::optional<Eigen::VectorXd> q = sampler_.sample(generator);
  if (q)
    for (const Eigen::Index joint : continuous_)
      (*q)[joint] = wrapped((*q)[joint]);
  return q;
}

Eigen::MatrixXd DistributionSampler::sample(std::mt19937_64& generator, Eigen::Index count) const {
  Eigen::MatrixXd drawn = sampler_.sample(generator, count);
  for (const Eigen::Index joint : continuous_)
    for (double& q : drawn.row(joint))
      q = wrapped(q);
  return drawn;
}

}  // namespace kinship::mixture
