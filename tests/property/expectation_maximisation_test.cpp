#include "server/density/expectation_maximisation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

namespace kinship::density::expectation_maximisation_test {
namespace {

constexpr int kCases = 30;

/// Points of a few overlapping groups with uneven weights, and a start somewhere among them.
struct Case {
  BlockPoints points;
  Mixture start;
};

Mixture next_of(const Expectation& current, const BlockPoints& points, double floor) {
  return maximisation(current.moments, points.offset(),
                      Eigen::VectorXd::Constant(points.dimension(), floor));
}

Case random_case(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> weight(0.1, 3);
  std::uniform_int_distribution<Eigen::Index> dimensions(1, 7);
  std::uniform_int_distribution<Eigen::Index> components(1, 6);
  const Eigen::Index dimension = dimensions(generator);
  const Eigen::Index count = 600;
  const auto draw = [&] { return normal(generator); };
  Eigen::MatrixXd points = Eigen::MatrixXd::NullaryExpr(dimension, count, draw);
  for (Eigen::Index i = 0; i < count; ++i)
    points.col(i).array() += 2 * static_cast<double>(i % 3);
  const DistinctPoints distinct = distinct_points(
      points, Eigen::VectorXd::NullaryExpr(count, [&] { return weight(generator); }));
  const Eigen::Index k = components(generator);
  return {BlockPoints(points, distinct, mean_of(points, distinct)),
          {Eigen::VectorXd::Constant(k, 1.0 / static_cast<double>(k)),
           2 * Eigen::MatrixXd::NullaryExpr(dimension, k, draw),
           std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(k),
                                        4 * Eigen::MatrixXd::Identity(dimension, dimension))}};
}

TEST(ExpectationMaximisation, NeverWorsensWithoutRegularisation) {
  for (std::uint64_t seed = 0; seed < kCases; ++seed) {
    Case example = random_case(seed);
    Expectation current = expectation(example.start, example.points, {});
    for (int iteration = 0; iteration < 25; ++iteration) {
      const Mixture next = next_of(current, example.points, 0);
      if (next.size() < current.moments.components())
        break;  // one lost its data: another problem
      const double before = current.mean_log_likelihood;
      current = expectation(next, example.points, {});
      EXPECT_GE(current.mean_log_likelihood, before - 1e-12)
          << "seed " << seed << ", iteration " << iteration;
    }
  }
}

/// What an iteration may lose by a floor L on variances, nats per point. Among covariances of at
/// least L, what fits a component's scatter S best has eigenvalues max(s, 1), in units of L; the
/// M-step's are s + 1. Half of log + s / eigenvalue is what each costs more.
double most_lost(const Mixture& without_floor, double floor) {
  double lost = 0;
  for (Eigen::Index k = 0; k < without_floor.size(); ++k) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> scatter(without_floor.covariance(k));
    for (double s : scatter.eigenvalues()) {
      s = std::max(s / floor, 0.0);
      const double best = std::log(std::max(s, 1.0)) + s / std::max(s, 1.0);
      lost += without_floor.weights()[k] * (std::log1p(s) + s / (1 + s) - best) / 2;
    }
  }
  return lost;
}

TEST(ExpectationMaximisation, WithRegularisationLossAndLikelihoodAreBounded) {
  double furthest_fall = 0;
  for (std::uint64_t seed = 0; seed < kCases; ++seed) {
    const double floor = std::pow(10.0, -static_cast<double>(seed % 5));
    const Case example = random_case(seed);
    const auto d = static_cast<double>(example.points.dimension());
    Mixture mixture =
        next_of(expectation(example.start, example.points, {}), example.points, floor);
    Expectation current = expectation(mixture, example.points, {});
    for (int iteration = 0; iteration < 15; ++iteration) {
      mixture = next_of(current, example.points, floor);
      if (mixture.size() < current.moments.components())
        break;  // one lost its data: another problem
      const double before = current.mean_log_likelihood;
      const double lost = most_lost(next_of(current, example.points, 0), floor);
      EXPECT_LE(lost, d * (std::log(2.0) - 0.5) / 2);  // whatever the points
      current = expectation(mixture, example.points, {});
      EXPECT_GE(current.mean_log_likelihood, before - lost - 1e-12)
          << "seed " << seed << ", iteration " << iteration;
      EXPECT_LE(current.mean_log_likelihood, -d * std::log(2 * M_PI * floor) / 2);
      furthest_fall = std::max(furthest_fall, before - current.mean_log_likelihood);
    }
  }
  EXPECT_GT(furthest_fall, 1e-6);  // else it would be the law without regularisation
}

TEST(ExpectationMaximisation, MixtureMeanIsThePointsMean) {
  for (std::uint64_t seed = 0; seed < kCases; ++seed) {
    const Case example = random_case(seed);
    const Mixture next =
        next_of(expectation(example.start, example.points, {}), example.points, 1e-4);
    if (next.size() < example.start.size())
      continue;
    EXPECT_LT((next.means() * next.weights() - example.points.offset()).cwiseAbs().maxCoeff(),
              1e-10)
        << "seed " << seed;
  }
}

}  // namespace
}  // namespace kinship::density::expectation_maximisation_test
