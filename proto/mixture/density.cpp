#include "proto/mixture/density.hpp"

#include <algorithm>
#include <stdexcept>

#include "proto/mixture/component_densities.hpp"

namespace kinship::mixture {

Eigen::VectorXd log_density(const Mixture& mixture,
                            const Eigen::Ref<const Eigen::MatrixXd>& configurations) {
  if (configurations.rows() != mixture.dimension())
    throw std::invalid_argument("log_density: configurations do not fit the mixture");
  constexpr Eigen::Index kBlock = 256;
  const ComponentDensities components(mixture);
  Eigen::VectorXd densities(configurations.cols());
  for (Eigen::Index begin = 0; begin < densities.size(); begin += kBlock) {
    const Eigen::Index count = std::min(kBlock, densities.size() - begin);
    densities.segment(begin, count) = log_sum_exp_of_rows(
        components.weighted_log_densities(configurations.middleCols(begin, count)));
  }
  return densities;
}

}  // namespace kinship::mixture
