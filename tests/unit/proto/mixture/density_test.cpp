#include "proto/mixture/density.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "proto/mixture/component_densities.hpp"
#include "proto/types/failure.hpp"

namespace kinship::mixture::density_test {
namespace {

constexpr std::uint64_t kSeed = 3;

Mixture two_components_2d() {
  Eigen::MatrixXd means(2, 2);
  means << -1, 0.5, 0.5, 0;
  Eigen::Matrix2d tilted;
  tilted << 0.5, 0.3, 0.3, 0.4;
  return {Eigen::Vector2d(0.3, 0.7), means, {tilted, 0.1 * Eigen::Matrix2d::Identity()}};
}

Mixture random_mixture(Eigen::Index components, Eigen::Index dimension) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  std::vector<Eigen::MatrixXd> covariances;
  for (Eigen::Index k = 0; k < components; ++k) {
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(dimension, dimension, draw);
    covariances.emplace_back(a * a.transpose() + Eigen::MatrixXd::Identity(dimension, dimension));
  }
  const Eigen::MatrixXd means = Eigen::MatrixXd::NullaryExpr(dimension, components, draw);
  return {Eigen::VectorXd::Constant(components, 1.0 / static_cast<double>(components)), means,
          covariances};
}

TEST(LogDensity, IntegratesToOneInOneDimension) {
  Eigen::MatrixXd means(1, 2);
  means << -1, 2;
  const Mixture mixture(
      Eigen::Vector2d(0.25, 0.75), means,
      {Eigen::MatrixXd::Constant(1, 1, 0.04), Eigen::MatrixXd::Constant(1, 1, 1.5)});
  constexpr Eigen::Index kCells = 20'000;
  const Eigen::RowVectorXd grid = Eigen::RowVectorXd::LinSpaced(kCells, -15, 15);
  const double step = 30.0 / static_cast<double>(kCells - 1);
  EXPECT_NEAR(log_density(mixture, grid).array().exp().sum() * step, 1, 1e-9);
}

TEST(LogDensity, SharedCovarianceIsOneForEach) {
  const Mixture apart = two_components_2d();
  const Eigen::MatrixXd covariance = apart.covariance(0);
  const Eigen::MatrixXd points = random_mixture(50, 2).means();
  EXPECT_EQ(log_density({apart.weights(), apart.means(), {covariance}}, points),
            log_density({apart.weights(), apart.means(), {covariance, covariance}}, points));
}

TEST(LogDensity, IntegratesToOneInTwoDimensions) {
  constexpr Eigen::Index kCells = 400;
  const double step = 12.0 / static_cast<double>(kCells);
  Eigen::MatrixXd grid(2, kCells * kCells);
  for (Eigen::Index i = 0; i < kCells; ++i)
    for (Eigen::Index j = 0; j < kCells; ++j)
      grid.col(i * kCells + j) << -6 + static_cast<double>(i) * step,
          -6 + static_cast<double>(j) * step;
  EXPECT_NEAR(log_density(two_components_2d(), grid).array().exp().sum() * step * step, 1, 1e-9);
}

TEST(LogDensity, EqualsTheFormulaWrittenOut) {
  const Mixture mixture = random_mixture(4, 3);
  const Eigen::MatrixXd points = 2 * Eigen::MatrixXd::Random(3, 600);  // more than two blocks
  const Eigen::VectorXd computed = log_density(mixture, points);
  for (Eigen::Index n = 0; n < points.cols(); ++n) {
    double density = 0;
    for (Eigen::Index k = 0; k < mixture.size(); ++k) {
      const Eigen::MatrixXd& covariance = mixture.covariances()[static_cast<std::size_t>(k)];
      const Eigen::VectorXd offset = points.col(n) - mixture.means().col(k);
      const double distance = offset.dot(covariance.inverse() * offset);
      density += mixture.weights()[k] * std::exp(-0.5 * distance) /
                 std::sqrt(std::pow(2 * std::numbers::pi, 3) * covariance.determinant());
    }
    EXPECT_NEAR(computed[n], std::log(density), 1e-10);
  }
}

TEST(LogDensity, IsFiniteHoweverFarAway) {
  Eigen::MatrixXd points(2, 5);
  points << 1e3, 1e8, 1e200, -1e308, 1e308,  //
      0, -1e8, 1e200, 1e308, 1e308;
  const Eigen::VectorXd densities = log_density(two_components_2d(), points);
  EXPECT_TRUE(densities.allFinite());
  EXPECT_LT(densities[1], densities[0]);
}

TEST(LogDensity, ComponentWithoutWeightAddsNothing) {
  const Mixture both = two_components_2d();
  const Mixture second_only(Eigen::Vector2d(0, 1), both.means(), both.covariances());
  const Mixture alone(Eigen::VectorXd::Ones(1), both.means().col(1), {both.covariances()[1]});
  const Eigen::MatrixXd points = Eigen::MatrixXd::Random(2, 10);
  EXPECT_TRUE(log_density(second_only, points).isApprox(log_density(alone, points), 1e-14));
}

TEST(LogDensity, RefusesWhatDoesNotFit) {
  EXPECT_THROW(log_density(two_components_2d(), Eigen::MatrixXd::Zero(3, 1)),
               std::invalid_argument);
  EXPECT_EQ(log_density(two_components_2d(), Eigen::MatrixXd::Zero(2, 0)).size(), 0);
}

TEST(LogDensity, CovarianceThatIsNotPositiveDefiniteIsNamed) {
  Eigen::Matrix2d indefinite;
  indefinite << 1, 2, 2, 1;
  const Mixture mixture(Eigen::Vector2d(0.5, 0.5), Eigen::MatrixXd::Zero(2, 2),
                        {Eigen::Matrix2d::Identity(), indefinite});
  try {
    log_density(mixture, Eigen::MatrixXd::Zero(2, 1));
    FAIL() << "accepted";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Internal);
    EXPECT_STREQ(failure.what(), "mixture: covariance of component 1 is not positive definite");
  }
}

TEST(LogSumExp, NeitherOverflowsNorUnderflows) {
  Eigen::MatrixXd terms(3, 2);
  terms << 1e4, 1e4, -1e4, -1e4, 0, -std::numeric_limits<double>::infinity();
  const Eigen::VectorXd sums = log_sum_exp_of_rows(terms);
  EXPECT_DOUBLE_EQ(sums[0], 1e4 + std::log(2));
  EXPECT_DOUBLE_EQ(sums[1], -1e4 + std::log(2));
  EXPECT_DOUBLE_EQ(sums[2], 0);
}

}  // namespace
}  // namespace kinship::mixture::density_test
