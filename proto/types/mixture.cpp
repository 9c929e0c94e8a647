#include "proto/types/mixture.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace kinship {

Mixture::Mixture(Eigen::VectorXd weights, Eigen::MatrixXd means,
                 std::vector<Eigen::MatrixXd> covariances)
    : weights_(std::move(weights)), means_(std::move(means)), covariances_(std::move(covariances)) {
  const Eigen::Index components = weights_.size();
  const Eigen::Index dimension = means_.rows();
  if (components < 1 || dimension < 1 || means_.cols() != components ||
      (covariances_.size() != 1 && static_cast<Eigen::Index>(covariances_.size()) != components))
    throw std::invalid_argument("Mixture: need K >= 1 weights, d x K means, K covariances or one");
  constexpr double kSumTolerance = 1e-6;
  if (!weights_.allFinite() || !means_.allFinite() || weights_.minCoeff() < 0 ||
      std::abs(weights_.sum() - 1) > kSumTolerance)
    throw std::invalid_argument("Mixture: weights must be >= 0 with sum 1, means finite");
  constexpr double kRounding = 1e-12;  // below it left alone: a written value reads back bit by bit
  if (std::abs(weights_.sum() - 1) > kRounding)
    weights_ /= weights_.sum();
  constexpr double kSymmetryTolerance = 1e-9;
  for (Eigen::MatrixXd& covariance : covariances_) {
    if (covariance.rows() != dimension || covariance.cols() != dimension || !covariance.allFinite())
      throw std::invalid_argument("Mixture: covariances must be d x d and finite");
    const double asymmetry = (covariance - covariance.transpose()).cwiseAbs().maxCoeff();
    if (asymmetry > kSymmetryTolerance * covariance.cwiseAbs().maxCoeff())
      throw std::invalid_argument("Mixture: covariances must be symmetric");
    if (asymmetry > 0)
      covariance = (0.5 * (covariance + covariance.transpose())).eval();
  }
}

}  // namespace kinship
