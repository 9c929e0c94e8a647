#include "server/density/responsibilities.hpp"

#include <gtest/gtest.h>

#include <random>

#include "proto/mixture/density.hpp"

namespace kinship::density {
namespace {

constexpr std::uint64_t kSeed = 7;

Mixture two_separated_components() {
  Eigen::MatrixXd means(2, 2);
  means << -2, 2, 0, 0;
  return {
      Eigen::Vector2d(0.5, 0.5), means, {Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity()}};
}

Eigen::MatrixXd uniform_points(double range, Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> joint(-range, range);
  return Eigen::MatrixXd::NullaryExpr(2, count, [&] { return joint(generator); });
}

TEST(Posterior, RowsSumToOneEvenFarFromEveryComponent) {
  const mixture::ComponentDensities components(two_separated_components());
  for (const double range : {1.0, 1e3, 1e8}) {
    const Eigen::MatrixXd r = posterior(components, uniform_points(range, 500)).responsibilities;
    EXPECT_TRUE((r.array() >= 0).all());
    EXPECT_LT((r.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
  }
}

TEST(Posterior, IsHalfAndHalfInTheMiddle) {
  const mixture::ComponentDensities components(two_separated_components());
  Eigen::MatrixXd points(2, 2);
  points << 0, 1, 3, 0;
  const Eigen::MatrixXd r = posterior(components, points).responsibilities;
  EXPECT_NEAR(r(0, 0), 0.5, 1e-15);
  EXPECT_NEAR(r(1, 1), 1 / (1 + std::exp(-4)), 1e-15);  // distances 9 and 1: exp((1 - 9) / 2)
}

TEST(Posterior, LogDensitiesAreThoseOfTheMixture) {
  const Mixture mixture = two_separated_components();
  const Eigen::MatrixXd points = uniform_points(5, 100);
  const Posterior result = posterior(mixture::ComponentDensities(mixture), points);
  EXPECT_TRUE(result.log_densities.isApprox(mixture::log_density(mixture, points), 1e-14));
}

TEST(Posterior, RefusesConfigurationsThatDoNotFit) {
  const mixture::ComponentDensities components(two_separated_components());
  EXPECT_THROW(posterior(components, Eigen::MatrixXd::Zero(3, 4)), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::density
