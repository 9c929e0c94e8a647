#include "proto/mixture/cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "proto/mixture/log_density.hpp"
#include "proto/types/failure.hpp"

namespace kinship::mixture::cholesky_test {
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
  const Eigen::MatrixXd points = 2 * Eigen::MatrixXd::Random(3, 600);
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

TEST(CholeskyFactors, NameACovarianceThatIsNotPositiveDefinite) {
  Eigen::Matrix2d indefinite;
  indefinite << 1, 2, 2, 1;
  const Mixture mixture(Eigen::Vector2d(0.5, 0.5), Eigen::MatrixXd::Zero(2, 2),
                        {Eigen::Matrix2d::Identity(), indefinite});
  try {
    cholesky_factors(mixture);
    FAIL() << "accepted";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Internal);
    EXPECT_STREQ(failure.what(), "mixture: covariance of component 1 is not positive definite");
  }
}

}  // namespace
}  // namespace kinship::mixture::cholesky_test
