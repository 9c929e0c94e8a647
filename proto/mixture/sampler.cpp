#include "proto/mixture/sampler.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "proto/mixture/cholesky.hpp"

namespace kinship::mixture {

Sampler::Sampler(const Mixture& mixture, Eigen::Matrix2Xd limits)
    : cumulative_weights_(static_cast<std::size_t>(mixture.size())),
      means_(mixture.means()),
      factors_(mixture.dimension(),
               mixture.dimension() * static_cast<Eigen::Index>(mixture.covariances().size())),
      limits_(std::move(limits)) {
  if (limits_.cols() != mixture.dimension())
    throw std::invalid_argument("Sampler: limits do not fit the mixture");
  if (!(limits_.row(0).array() <= limits_.row(1).array()).all())
    throw std::invalid_argument("Sampler: a lower limit exceeds its upper limit");
  std::partial_sum(mixture.weights().begin(), mixture.weights().end(), cumulative_weights_.begin());
  Eigen::Index column = 0;
  for (const Eigen::MatrixXd& factor : cholesky_factors(mixture)) {
    factors_.middleCols(column, dimension()) = factor.transpose();
    column += dimension();
  }
}

Eigen::Index Sampler::draw_component(std::mt19937_64& generator) const {
  std::uniform_real_distribution<double> uniform(0, cumulative_weights_.back());
  const auto chosen = std::upper_bound(cumulative_weights_.begin(), cumulative_weights_.end() - 1,
                                       uniform(generator));
  return chosen - cumulative_weights_.begin();
}

std::optional<Eigen::VectorXd> Sampler::sample(std::mt19937_64& generator) const {
  std::normal_distribution<double> normal;
  Eigen::VectorXd noise(dimension());
  Eigen::VectorXd configuration(dimension());
  const bool one_factor = factors_.cols() == dimension();
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const Eigen::Index component = draw_component(generator);
    for (double& value : noise)
      value = normal(generator);
    const Eigen::Index first_row = one_factor ? 0 : component * dimension();
    bool inside = true;
    for (Eigen::Index joint = 0; joint < dimension() && inside; ++joint) {
      const auto factor_row = factors_.col(first_row + joint);
      configuration[joint] =
          means_(joint, component) + factor_row.head(joint + 1).dot(noise.head(joint + 1));
      inside =
          configuration[joint] >= limits_(0, joint) && configuration[joint] <= limits_(1, joint);
    }
    if (inside)
      return configuration;
  }
  return std::nullopt;
}

}  // namespace kinship::mixture
