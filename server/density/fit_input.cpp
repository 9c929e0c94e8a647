#include "server/density/fit_input.hpp"

#include <cmath>
#include <string>

namespace kinship::density {

std::optional<Error> check_input(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                 const Eigen::Ref<const Eigen::VectorXd>& weights) {
  for (Eigen::Index i = 0; i < configurations.cols(); ++i) {
    if (!(configurations.col(i).cwiseAbs().array() <= kLargestValue).all())
      return Error{ErrorCode::InvalidInput, "fit: configuration " + std::to_string(i) +
                                                " is not finite or exceeds " +
                                                std::to_string(kLargestValue)};
    if (!(weights[i] >= 0) || !std::isfinite(weights[i]))
      return Error{ErrorCode::InvalidInput, "fit: weight " + std::to_string(i) + " is " +
                                                std::to_string(weights[i]) +
                                                ", must be finite and at least 0"};
  }
  if (!(weights.sum() > 0) || !std::isfinite(weights.sum()))
    return Error{ErrorCode::InvalidInput, "fit: weights have sum " + std::to_string(weights.sum()) +
                                              ", must be positive and finite"};
  return std::nullopt;
}

double log_uniform(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                   const Eigen::Matrix2Xd& limits) {
  constexpr double kLeastWidth = 1e-6;  // of a joint that does not move
  Eigen::Matrix2Xd box = limits;
  if (box.size() == 0) {
    box.resize(2, configurations.rows());
    box.row(0) = configurations.rowwise().minCoeff().transpose();
    box.row(1) = configurations.rowwise().maxCoeff().transpose();
  }
  const Eigen::ArrayXd widths = (box.row(1) - box.row(0)).transpose().array();
  return -widths.max(kLeastWidth).log().sum();
}

}  // namespace kinship::density
