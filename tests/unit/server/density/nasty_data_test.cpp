// What no planner should report but one will: a defined error or a usable mixture.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "proto/mixture/log_density.hpp"
#include "server/density/fit.hpp"

namespace kinship::density::nasty_data_test {
namespace {

constexpr std::uint64_t kSeed = 37;

Eigen::MatrixXd normal_points(Eigen::Index dimension, Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(dimension, count, [&] { return normal(generator); });
}

std::vector<std::uint32_t> paths_of_ten(Eigen::Index count) {
  std::vector<std::uint32_t> path_of;
  for (Eigen::Index i = 0; i < count; ++i)
    path_of.push_back(static_cast<std::uint32_t>(i / 10));
  return path_of;
}

/// Fixed and chosen K, pruned and dense agree that there is a mixture with which one can work.
void expect_usable(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights) {
  for (const int components : {0, 1, 20}) {
    FitOptions options;
    options.components = components;
    options.path_of_configuration = paths_of_ten(points.cols());
    const auto fitted = fit_mixture(points, weights, options);
    ASSERT_TRUE(fitted) << fitted.error().message;
    const Mixture& mixture = fitted->mixture;
    EXPECT_NEAR(mixture.weights().sum(), 1, 1e-12);
    for (const Eigen::MatrixXd& covariance : mixture.covariances()) {
      const double largest = covariance.cwiseAbs().maxCoeff();
      EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).eigenvalues()[0],
                1e-4 * (1 - 1e-9) - 1e-13 * largest);
    }
    EXPECT_TRUE(kinship::mixture::log_density(mixture, points).allFinite());
    options.computation.prune = false;
    const Mixture dense = fit_mixture(points, weights, options)->mixture;
    ASSERT_EQ(dense.size(), mixture.size());
    EXPECT_LT((dense.means() - mixture.means()).cwiseAbs().maxCoeff(),
              1e-9 * (1 + points.cwiseAbs().maxCoeff()));
  }
}

void expect_usable(const Eigen::MatrixXd& points) {
  expect_usable(points, Eigen::VectorXd::Ones(points.cols()));
}

TEST(NastyData, MoreComponentsThanPoints) {
  for (const Eigen::Index count : {8, 9, 15, 16, 40})
    expect_usable(normal_points(7, count));
}

TEST(NastyData, MillionsOfUnits) {
  expect_usable(2e5 * normal_points(6, 500).cwiseMax(-4).cwiseMin(4));
  expect_usable((1e-3 * normal_points(3, 500).array() + 9e5).matrix());
}

TEST(NastyData, EveryDimensionUpToTheLimit) {
  for (const Eigen::Index dimension : {1, 2, 9, 16, 32})
    expect_usable(normal_points(dimension, 6 * (dimension + 1)));
}

}  // namespace
}  // namespace kinship::density::nasty_data_test
