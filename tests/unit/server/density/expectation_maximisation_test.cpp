#include "server/density/expectation_maximisation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "proto/mixture/density.hpp"

namespace kinship::density {
namespace {

constexpr std::uint64_t kSeed = 9;

WeightedPoints random_points(Eigen::Index dimension, Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> weight(0.5, 2);
  const Eigen::MatrixXd points =
      Eigen::MatrixXd::NullaryExpr(dimension, count, [&] { return normal(generator); });
  return prepare_points(points,
                        Eigen::VectorXd::NullaryExpr(count, [&] { return weight(generator); }));
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
  const WeightedPoints points = random_points(3, 700);
  const Mixture mixture = start_of(3, 5);
  const Expectation result = expectation(mixture, points);
  EXPECT_NEAR(result.moments.masses.sum(), 700, 1e-9);
  EXPECT_NEAR(result.mean_log_likelihood,
              points.weights.dot(mixture::log_density(mixture, points.points)) / 700, 1e-12);
}

TEST(Maximisation, OfOneComponentIsWeightedMeanAndCovariance) {
  const WeightedPoints points = random_points(3, 300);
  const Mixture mixture = maximisation(expectation(start_of(3, 1), points).moments, 0);
  const Eigen::MatrixXd covariance =
      points.points * points.weights.asDiagonal() * points.points.transpose() / 300;
  EXPECT_LT(mixture.means().cwiseAbs().maxCoeff(), 1e-12);  // points are relative to their mean
  EXPECT_TRUE(mixture.covariances()[0].isApprox(covariance, 1e-12));
}

TEST(Maximisation, EqualsTheFormulasWrittenOut) {
  const WeightedPoints points = random_points(2, 400);
  const Mixture start = start_of(2, 3);
  const Mixture next = maximisation(expectation(start, points).moments, 1e-3);
  Eigen::MatrixXd r(400, 3);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Mixture alone(Eigen::VectorXd::Ones(1), start.means().col(k),
                        {start.covariances()[static_cast<std::size_t>(k)]});
    r.col(k) = start.weights()[k] * mixture::log_density(alone, points.points).array().exp();
  }
  r.array().colwise() *= points.weights.array() / r.rowwise().sum().array();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double mass = r.col(k).sum();
    const Eigen::Vector2d mean = points.points * r.col(k) / mass;
    const Eigen::MatrixXd centred = points.points.colwise() - mean;
    const Eigen::Matrix2d covariance =
        centred * r.col(k).asDiagonal() * centred.transpose() / mass +
        1e-3 * Eigen::Matrix2d::Identity();
    EXPECT_NEAR(next.weights()[k], mass / 400, 1e-12);
    EXPECT_TRUE(next.means().col(k).isApprox(mean, 1e-10));
    EXPECT_TRUE(next.covariances()[static_cast<std::size_t>(k)].isApprox(covariance, 1e-10));
  }
}

TEST(Maximisation, ComponentThatLostItsDataIsLeftOut) {
  const WeightedPoints points = random_points(2, 200);
  Mixture start = start_of(2, 3);
  Eigen::MatrixXd means = start.means();
  means.col(1).setConstant(500);
  start = Mixture(start.weights(), means, start.covariances());
  const Mixture next = maximisation(expectation(start, points).moments, 1e-4);
  EXPECT_EQ(next.size(), 2);
  EXPECT_NEAR(next.weights().sum(), 1, 1e-15);
}

TEST(Maximisation, FloorIsTheLeastEigenvalue) {
  WeightedPoints points = random_points(3, 200);
  points.points.row(1) = 2 * points.points.row(0);  // singular without the floor
  const Mixture mixture = maximisation(expectation(start_of(3, 4), points).moments, 1e-4);
  for (const Eigen::MatrixXd& covariance : mixture.covariances())
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).eigenvalues()[0],
              1e-4 * (1 - 1e-9));
}

TEST(MomentsOfClusters, AreThoseOfTheirPoints) {
  const WeightedPoints points = random_points(2, 300);
  std::vector<Eigen::Index> cluster(300, 0);
  for (std::size_t i = 150; i < 300; ++i)
    cluster[i] = 1;
  const Moments moments = moments_of_clusters(points, cluster, 2);
  EXPECT_NEAR(moments.masses[1], points.weights.tail(150).sum(), 1e-10);
  const Eigen::Vector2d sum = points.points.leftCols(150) * points.weights.head(150);
  EXPECT_TRUE(moments.sums.col(0).isApprox(sum, 1e-10));
}

}  // namespace
}  // namespace kinship::density
