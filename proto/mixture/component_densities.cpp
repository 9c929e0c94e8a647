#include "proto/mixture/component_densities.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "proto/mixture/cholesky.hpp"

namespace kinship::mixture {

ComponentDensities::ComponentDensities(const Mixture& mixture)
    : means_(mixture.means()), log_scales_(mixture.size()) {
  const Eigen::Index dimension = mixture.dimension();
  const double log_two_pi = std::log(2 * std::numbers::pi);
  const std::vector<Eigen::MatrixXd> factors = cholesky_factors(mixture);
  whitenings_.reserve(factors.size());
  for (const Eigen::MatrixXd& factor : factors)
    whitenings_.emplace_back(factor.triangularView<Eigen::Lower>().solve(
        Eigen::MatrixXd::Identity(dimension, dimension)));
  for (Eigen::Index k = 0; k < mixture.size(); ++k) {
    const Eigen::MatrixXd& factor = factors[mixture.covariance_index(k)];
    log_scales_[k] = std::log(mixture.weights()[k]) - factor.diagonal().array().log().sum() -
                     0.5 * static_cast<double>(dimension) * log_two_pi;
  }
}

Eigen::MatrixXd ComponentDensities::weighted_log_densities(
    const Eigen::Ref<const Eigen::MatrixXd>& configurations) const {
  if (configurations.rows() != dimension())
    throw std::invalid_argument("weighted_log_densities: configurations do not fit the mixture");
  constexpr double kLargestDistance = 1e300;  // squared; beyond it and for inf - inf
  const Eigen::MatrixXd points = configurations.transpose();  // N x d: columns to vectorise over
  Eigen::MatrixXd terms(points.rows(), size());
  Eigen::ArrayXd whitened(points.rows());
  Eigen::ArrayXd distance(points.rows());
  for (Eigen::Index k = 0; k < size(); ++k) {
    const Eigen::MatrixXd& whitening =
        whitenings_[whitenings_.size() == 1 ? 0 : static_cast<std::size_t>(k)];
    const Eigen::VectorXd offset = whitening.triangularView<Eigen::Lower>() * means_.col(k);
    distance.setZero();
    for (Eigen::Index row = 0; row < dimension(); ++row) {
      whitened.setConstant(-offset[row]);
      for (Eigen::Index column = 0; column <= row; ++column)
        whitened += whitening(row, column) * points.col(column).array();
      distance += whitened.square();
    }
    terms.col(k) =
        log_scales_[k] - 0.5 * (distance < kLargestDistance).select(distance, kLargestDistance);
  }
  return terms;
}

Eigen::VectorXd log_sum_exp_of_rows(const Eigen::Ref<const Eigen::MatrixXd>& terms) {
  Eigen::ArrayXd largest = terms.col(0);
  for (Eigen::Index k = 1; k < terms.cols(); ++k)
    largest = largest.max(terms.col(k).array());
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(terms.rows());
  for (Eigen::Index k = 0; k < terms.cols(); ++k)
    sum += (terms.col(k).array() - largest).exp();
  return largest + sum.log();
}

}  // namespace kinship::mixture
