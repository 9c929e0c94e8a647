#include "server/density/expectation_maximisation.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kinship::density {
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
}  // namespace kinship::density
