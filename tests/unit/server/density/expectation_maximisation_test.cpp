#include "server/density/expectation_maximisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "proto/mixture/log_density.hpp"
#include "proto/types/failure.hpp"
#include "server/density/em_run.hpp"

namespace kinship::density::expectation_maximisation_test {
namespace {

constexpr std::uint64_t kSeed = 9;

/// Points, and the same as columns with weights, to compare with formulas written out.
struct Example {
  Eigen::MatrixXd columns;
  Eigen::VectorXd weights;  // mean 1
  BlockPoints points;
};

Example example_of(const Eigen::MatrixXd& columns, Eigen::VectorXd weights) {
  weights /= weights.mean();
  const DistinctPoints distinct = distinct_points(columns, weights);
  return {columns, weights, BlockPoints(columns, distinct, mean_of(columns, distinct))};
}

Example random_points(Eigen::Index dimension, Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> weight(0.5, 2);
  return example_of(
      Eigen::MatrixXd::NullaryExpr(dimension, count, [&] { return normal(generator); }),
      Eigen::VectorXd::NullaryExpr(count, [&] { return weight(generator); }));
}

Mixture next_of(const Mixture& start, const Example& example, double floor) {
  return maximisation(expectation(start, example.points, {}).moments, example.points.offset(),
                      Eigen::VectorXd::Constant(start.dimension(), floor));
}

Mixture start_of(Eigen::Index dimension, Eigen::Index components) {
  std::mt19937_64 generator(kSeed + 1);
  std::normal_distribution<double> normal;
  return {Eigen::VectorXd::Constant(components, 1.0 / static_cast<double>(components)),
          Eigen::MatrixXd::NullaryExpr(dimension, components, [&] { return normal(generator); }),
          std::vector<Eigen::MatrixXd>(static_cast<std::size_t>(components),
                                       Eigen::MatrixXd::Identity(dimension, dimension))};
}

TEST(Expectation, MassesSumToTheWeightsAndTheLikelihoodIsTheMixtures) {
  for (const Eigen::Index dimension : {1, 3, 7, 11, 32}) {
    const Example example = random_points(dimension, 700);
    const Mixture mixture = start_of(dimension, 5);
    const Expectation result = expectation(mixture, example.points, {});
    EXPECT_NEAR(result.moments.sums.row(0).sum(), 700, 1e-9);
    EXPECT_NEAR(result.mean_log_likelihood,
                example.weights.dot(kinship::mixture::log_density(mixture, example.columns)) / 700,
                1e-13 * std::abs(result.mean_log_likelihood));
  }
}

TEST(MeanLogDensity, IsThatOfTheMixtureWithItsBackground) {
  const Example example = random_points(3, 500);
  const Mixture mixture = start_of(3, 4);
  const Eigen::ArrayXd densities =
      kinship::mixture::log_density(mixture, example.columns).array().exp();
  EXPECT_NEAR(mean_log_density(mixture, example.points, 0, 0, {}),
              expectation(mixture, example.points, {}).mean_log_likelihood, 1e-13);
  const double expected =
      example.weights.dot((0.99 * densities + 0.01 * std::exp(-3.0)).log().matrix()) / 500;
  EXPECT_NEAR(mean_log_density(mixture, example.points, 0.01, -3, {}), expected, 1e-12);
}

/// Tight components among spread ones, so that most pairs of block and component can be left out.
Mixture uneven_start(const Example& example, Eigen::Index components) {
  Eigen::MatrixXd means(example.columns.rows(), components);
  std::vector<Eigen::MatrixXd> covariances;
  for (Eigen::Index k = 0; k < components; ++k) {
    means.col(k) = example.columns.col(k * (example.columns.cols() / components));
    covariances.emplace_back(std::pow(10.0, -static_cast<double>(k % 4)) *
                             Eigen::MatrixXd::Identity(means.rows(), means.rows()));
  }
  return {Eigen::VectorXd::Constant(components, 1.0 / static_cast<double>(components)), means,
          covariances};
}

TEST(LogDensities, AreTheMixturesPointByPoint) {
  const Example example = random_points(3, 700);
  const Mixture mixture = start_of(3, 5);
  const Eigen::VectorXd densities = log_densities(mixture, example.points, {.threads = 2});
  ASSERT_EQ(densities.size(), example.points.size());
  for (Eigen::Index i = 0; i < densities.size(); ++i) {
    const Eigen::VectorXd point = example.points.point(i) + example.points.offset();
    EXPECT_NEAR(densities[i], kinship::mixture::log_density(mixture, point)[0], 1e-11) << i;
  }
}

TEST(Expectation, PrunedEqualsDense) {
  for (const Eigen::Index dimension : {2, 5, 7, 9}) {
    const Example example = random_points(dimension, 3000);
    const Mixture start = uneven_start(example, 40);
    const Expectation dense = expectation(start, example.points, {.prune = false});
    const Expectation pruned = expectation(start, example.points, {.prune = true});
    EXPECT_NEAR(pruned.mean_log_likelihood, dense.mean_log_likelihood,
                1e-12 * std::abs(dense.mean_log_likelihood));
    EXPECT_LT((pruned.moments.sums - dense.moments.sums).cwiseAbs().maxCoeff(),
              1e-12 * dense.moments.sums.cwiseAbs().maxCoeff());
  }
}

/// Squares of its whitened points would be infinite.
TEST(Expectation, AComponentTooNarrowToComputeWithIsNamed) {
  const Example example = random_points(2, 200);
  const Mixture start = start_of(2, 3);
  std::vector<Eigen::MatrixXd> covariances = start.covariances();
  covariances[1] *= 1e-310;
  try {
    static_cast<void>(
        expectation({start.weights(), start.means(), covariances}, example.points, {}));
    ADD_FAILURE() << "computed";
  } catch (const Failure& failure) {
    EXPECT_EQ(std::string(failure.what()), "mixture: component 1 is too narrow to compute with");
  }
}

TEST(Expectation, SameBytesForAnyNumberOfThreads) {
  const Example example = random_points(6, 9000);
  const Mixture start = uneven_start(example, 30);
  const Expectation one = expectation(start, example.points, {.threads = 1});
  for (const int threads : {2, 3, 16}) {
    const Expectation several = expectation(start, example.points, {.threads = threads});
    EXPECT_EQ(several.moments.sums, one.moments.sums);
    EXPECT_EQ(several.mean_log_likelihood, one.mean_log_likelihood);
  }
}

/// The log-likelihoods that scikit-learn 1.2.1 finds (GaussianMixture, reg_covar 1e-4, tol 0, the
/// same start) after 1 and 7 iterations.
TEST(ExpectationMaximisation, EqualsScikitLearns) {
  Eigen::MatrixXd columns(3, 90);
  for (int i = 0; i < 90; ++i)
    columns.col(i) << std::sin(i) + 0.8 * (i % 4),
        0.6 * std::cos(1.7 * i) - 0.2 * (i % 4) * (i % 4),
        0.3 * std::sin(0.37 * i * i) + 0.5 * (i % 2);
  const Example example = example_of(columns, Eigen::VectorXd::Ones(90));
  const Mixture start(Eigen::VectorXd::Constant(4, 0.25), columns.leftCols(4),
                      std::vector<Eigen::MatrixXd>(4, Eigen::MatrixXd::Identity(3, 3)));
  for (const bool prune : {true, false}) {
    const EmOptions options{.floors = Eigen::VectorXd::Constant(3, 1e-4),
                            .max_iterations = 7,
                            .tolerance = -1,
                            .computation = {.prune = prune}};
    const EmRun run = run_em(start, example.points, options);
    ASSERT_EQ(run.log_likelihoods.size(), 7U);
    EXPECT_NEAR(run.log_likelihoods.front(), -2.6229793707957976, 1e-9);
    EXPECT_NEAR(run.log_likelihoods.back(), -2.4911138174512177, 1e-9);
  }
}

TEST(ExpectationMaximisation, FromAKnownExpectationTheMixtureIsTheSame) {
  const Example example = random_points(3, 900);
  const Mixture start = start_of(3, 6);
  for (const double prior : {0.0, 20.0})
    for (const int iterations : {0, 1, 4, 50}) {
      EmOptions options{Eigen::VectorXd::Constant(3, 1e-4), iterations};
      options.prior_scatter = prior * Eigen::MatrixXd::Identity(3, 3);
      const EmRun run = run_em(start, example.points, options);
      const Mixture same =
          run_em_from(start, expectation(start, example.points, {}), example.points, options);
      EXPECT_EQ(same.means(), run.mixture.means()) << iterations;
      EXPECT_EQ(same.covariances(), run.mixture.covariances()) << iterations;
    }
}

TEST(Maximisation, EqualsTheFormulasWrittenOut) {
  const Example example = random_points(2, 400);
  const Mixture start = start_of(2, 3);
  const Mixture next = next_of(start, example, 1e-3);
  Eigen::MatrixXd r(400, 3);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Mixture alone(Eigen::VectorXd::Ones(1), start.means().col(k),
                        {start.covariances()[static_cast<std::size_t>(k)]});
    r.col(k) =
        start.weights()[k] * kinship::mixture::log_density(alone, example.columns).array().exp();
  }
  r.array().colwise() *= example.weights.array() / r.rowwise().sum().array();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double mass = r.col(k).sum();
    const Eigen::Vector2d mean = example.columns * r.col(k) / mass;
    const Eigen::MatrixXd centred = example.columns.colwise() - mean;
    const Eigen::Matrix2d covariance =
        centred * r.col(k).asDiagonal() * centred.transpose() / mass +
        1e-3 * Eigen::Matrix2d::Identity();
    EXPECT_NEAR(next.weights()[k], mass / 400, 1e-12);
    EXPECT_TRUE(next.means().col(k).isApprox(mean, 1e-10));
    EXPECT_TRUE(next.covariances()[static_cast<std::size_t>(k)].isApprox(covariance, 1e-10));
  }
}

TEST(Maximisation, ComponentThatLostItsDataIsLeftOut) {
  const Example example = random_points(2, 200);
  Mixture start = start_of(2, 3);
  Eigen::MatrixXd means = start.means();
  means.col(1).setConstant(500);
  start = Mixture(start.weights(), means, start.covariances());
  const Mixture next = next_of(start, example, 1e-4);
  EXPECT_EQ(next.size(), 2);
  EXPECT_NEAR(next.weights().sum(), 1, 1e-15);
}

/// A component of 40 points has lost nothing where one of twenty is looked at.
TEST(Maximisation, OfASampleLeavesOutWhatAllPointsWould) {
  const Example example = random_points(2, 200);
  Moments moments = expectation(start_of(2, 3), example.points, {}).moments;
  moments.sums.col(1) *= 2 / moments.mass(1);
  const auto size_of = [&](double share) {
    return maximisation(moments, example.points.offset(), Eigen::Vector2d::Constant(1e-4), {},
                        share)
        .size();
  };
  EXPECT_EQ(size_of(1), 2);
  EXPECT_EQ(size_of(0.7), 2);
  EXPECT_EQ(size_of(0.05), 3);
}

TEST(Maximisation, FloorOfEachJointIsAddedToItsVariance) {
  const Example example = random_points(3, 200);
  const Eigen::Vector3d floors(1e-4, 2e-2, 0);
  const Moments moments = expectation(start_of(3, 4), example.points, {}).moments;
  const Mixture with = maximisation(moments, example.points.offset(), floors);
  const Mixture without = maximisation(moments, example.points.offset(), Eigen::Vector3d::Zero());
  const Eigen::MatrixXd difference = with.covariances()[2] - without.covariances()[2];
  EXPECT_TRUE(difference.isApprox(Eigen::MatrixXd(floors.asDiagonal()), 1e-12));
}

}  // namespace
}  // namespace kinship::density::expectation_maximisation_test
