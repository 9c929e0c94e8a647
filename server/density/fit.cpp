#include "server/density/fit.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "server/density/expectation_maximisation.hpp"
#include "server/density/kmeans.hpp"
#include "server/density/weighted_points.hpp"

namespace kinship::density {
namespace {

constexpr Eigen::Index kMaxStartPoints = 20'000;  // k-means sees at most so many
constexpr int kLloydIterations = 10;
constexpr double kLargestValue = 1e6;  // joint units; squares of it still leave room for the floor

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

/// Every how-many-th point, so that at most kMaxStartPoints are left.
WeightedPoints thinned(const WeightedPoints& points) {
  const Eigen::Index step = (points.points.cols() - 1) / kMaxStartPoints + 1;
  const auto every = Eigen::seq(Eigen::Index{0}, points.points.cols() - 1, step);
  return {points.points(Eigen::all, every), points.weights(every), points.offset};
}

/// The mixture of k-means clusters.
Mixture start_mixture(const WeightedPoints& points, Eigen::Index components,
                      const FitOptions& options) {
  std::mt19937_64 generator(options.seed);
  const WeightedPoints sample = thinned(points);
  const Eigen::MatrixXd centres = move_centres(
      sample.points, sample.weights,
      choose_centres(sample.points, sample.weights, components, generator), kLloydIterations);
  return maximisation(
      moments_of_clusters(points, nearest_centres(points.points, centres), centres.cols()),
      options.covariance_floor);
}

FitSummary fit_points(const WeightedPoints& points, Eigen::Index components,
                      const FitOptions& options) {
  Mixture mixture = start_mixture(points, components, options);
  Expectation current = expectation(mixture, points);
  std::vector<double> log_likelihoods;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    mixture = maximisation(current.moments, options.covariance_floor);
    const double before = current.mean_log_likelihood;
    current = expectation(mixture, points);
    log_likelihoods.push_back(current.mean_log_likelihood);
    if (current.mean_log_likelihood - before < options.tolerance)
      break;
  }
  return {{mixture.weights(), mixture.means().colwise() + points.offset, mixture.covariances()},
          std::move(log_likelihoods)};
}

}  // namespace

Result<FitSummary> fit_mixture(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const FitOptions& options) {
  if (configurations.cols() != weights.size())
    throw std::invalid_argument("fit_mixture: one weight per configuration");
  if (options.components < 1 || !(options.covariance_floor >= 0) ||
      !std::isfinite(options.covariance_floor))
    throw std::invalid_argument(
        "fit_mixture: need components >= 1, a finite covariance_floor >= 0");
  if (const auto error = check_input(configurations, weights))
    return *error;

  const WeightedPoints points = prepare_points(configurations, weights);
  const Eigen::Index distinct = points.points.cols();
  const Eigen::Index least = configurations.rows() + 1;
  if (distinct < least)
    return Error{ErrorCode::InvalidInput, "fit: " + std::to_string(distinct) +
                                              " distinct configurations, need at least " +
                                              std::to_string(least) + " for " +
                                              std::to_string(configurations.rows()) + " joints"};
  const Eigen::Index components =
      std::clamp(distinct / (2 * least), Eigen::Index{1}, Eigen::Index{options.components});
  try {
    return fit_points(points, components, options);
  } catch (const Failure& failure) {
    return Error{ErrorCode::InvalidInput,
                 std::string("fit: ") + failure.what() + "; covariance_floor " +
                     std::to_string(options.covariance_floor) + " is too small for this data"};
  }
}

}  // namespace kinship::density
