#include "proto/mixture/log_density.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "proto/mixture/cholesky.hpp"
#include "proto/types/turn.hpp"

namespace kinship::mixture {
namespace {

constexpr Eigen::Index kAtOnce = 4096;  // configurations: so much memory is K times that

Eigen::VectorXd log_density_of_few(const Mixture& mixture,
                                   const std::vector<Eigen::MatrixXd>& factors,
                                   const Eigen::Ref<const Eigen::MatrixXd>& configurations) {
  const double log_unit =
      0.5 * static_cast<double>(mixture.dimension()) * std::log(2 * std::numbers::pi);
  Eigen::MatrixXd terms(configurations.cols(), mixture.size());
  for (Eigen::Index k = 0; k < mixture.size(); ++k) {
    const Eigen::MatrixXd& factor = factors[mixture.covariance_index(k)];
    Eigen::MatrixXd whitened = configurations.colwise() - mixture.means().col(k);
    factor.triangularView<Eigen::Lower>().solveInPlace(whitened);
    const double log_scale =
        std::log(mixture.weights()[k]) - factor.diagonal().array().log().sum() - log_unit;
    terms.col(k) = log_scale - 0.5 * whitened.colwise().squaredNorm().transpose().array();
  }
  const Eigen::VectorXd largest = terms.rowwise().maxCoeff();
  return largest.array() + (terms.colwise() - largest).array().exp().rowwise().sum().log();
}

}  // namespace

Eigen::VectorXd log_density(const Mixture& mixture,
                            const Eigen::Ref<const Eigen::MatrixXd>& configurations) {
  if (configurations.rows() != mixture.dimension())
    throw std::invalid_argument("log_density: configurations of " +
                                std::to_string(configurations.rows()) + " joints, mixture of " +
                                std::to_string(mixture.dimension()));
  const std::vector<Eigen::MatrixXd> factors = cholesky_factors(mixture);
  Eigen::VectorXd densities(configurations.cols());
  for (Eigen::Index at = 0; at < configurations.cols(); at += kAtOnce) {
    const Eigen::Index count = std::min(kAtOnce, configurations.cols() - at);
    densities.segment(at, count) =
        log_density_of_few(mixture, factors, configurations.middleCols(at, count));
  }
  return densities;
}

Eigen::VectorXd log_density(const Distribution& distribution,
                            const Eigen::Ref<const Eigen::MatrixXd>& configurations) {
  const auto joints = static_cast<Eigen::Index>(distribution.cuts.size());
  if (joints == 0 || configurations.rows() != joints)
    return log_density(distribution.mixture.value(), configurations);
  Eigen::MatrixXd turned = configurations;
  for (Eigen::Index joint = 0; joint < joints; ++joint)
    if (const auto& cut = distribution.cuts[static_cast<std::size_t>(joint)]) {
      const double middle = *cut + std::numbers::pi;
      for (double& value : turned.row(joint))
        value = middle + wrapped(value - middle);
    }
  return log_density(distribution.mixture.value(), turned);
}

}  // namespace kinship::mixture
