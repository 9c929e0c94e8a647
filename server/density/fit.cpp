#include "server/density/fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "server/density/block_points.hpp"
#include "server/density/distinct_points.hpp"
#include "server/density/em_run.hpp"

namespace kinship::density {
namespace {

constexpr double kLargestValue = 1e6;  // joint units; squares of it still leave room for the floor

void check_options(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                   const Eigen::Ref<const Eigen::VectorXd>& weights, const FitOptions& options) {
  if (configurations.cols() != weights.size())
    throw std::invalid_argument("fit_mixture: one weight per configuration");
  if (options.components < 1 || !(options.covariance_floor >= 0) ||
      !std::isfinite(options.covariance_floor))
    throw std::invalid_argument(
        "fit_mixture: need components >= 1, a finite covariance_floor >= 0");
  const Eigen::VectorXd& floors = options.floors_of_joints;
  if (floors.size() != 0 &&
      (floors.size() != configurations.rows() || !floors.allFinite() || floors.minCoeff() < 0))
    throw std::invalid_argument("fit_mixture: need one finite floor >= 0 per joint");
}

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

EmOptions em_options(Eigen::Index dimension, const FitOptions& options) {
  return {options.floors_of_joints.size() > 0
              ? options.floors_of_joints
              : Eigen::VectorXd::Constant(dimension, options.covariance_floor),
          options.max_iterations, options.tolerance, options.computation};
}

FitSummary fit_points(const BlockPoints& points, Eigen::Index components,
                      const FitOptions& options) {
  EmOptions em = em_options(points.dimension(), options);
  Mixture start = start_mixture(thinned(points, kSamplePoints), components, options.seed, em);
  const Eigen::Index sample = std::max(kSamplePoints, kSamplePointsPerComponent * components);
  if (points.size() > 4 * sample) {
    start = run_em(std::move(start), thinned(points, sample), em).mixture;
    em.max_iterations = std::min(em.max_iterations, kFullPasses);
  }
  EmRun run = run_em(std::move(start), points, em);
  return {std::move(run.mixture), std::move(run.log_likelihoods)};
}

}  // namespace

Result<FitSummary> fit_mixture(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const FitOptions& options) {
  check_options(configurations, weights, options);
  if (const auto error = check_input(configurations, weights))
    return *error;

  DistinctPoints distinct = distinct_points(configurations, weights);
  const auto count = static_cast<Eigen::Index>(distinct.columns.size());
  const Eigen::Index least = configurations.rows() + 1;
  if (count < least)
    return Error{ErrorCode::InvalidInput, "fit: " + std::to_string(count) +
                                              " distinct configurations, need at least " +
                                              std::to_string(least) + " for " +
                                              std::to_string(configurations.rows()) + " joints"};
  const Eigen::Index components =
      std::clamp(count / (2 * least), Eigen::Index{1}, Eigen::Index{options.components});
  try {
    const Eigen::VectorXd mean = mean_of(configurations, distinct);
    return fit_points({configurations, std::move(distinct), mean}, components, options);
  } catch (const Failure& failure) {
    return Error{ErrorCode::InvalidInput,
                 std::string("fit: ") + failure.what() + "; covariance_floor " +
                     std::to_string(options.covariance_floor) + " is too small for this data"};
  }
}

}  // namespace kinship::density
