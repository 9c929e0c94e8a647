#include "server/density/fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>
#include <random>
#include <stdexcept>

#include "proto/mixture/log_density.hpp"

namespace kinship::density::fit_test {
namespace {

constexpr std::uint64_t kSeed = 13;

Mixture known_mixture() {
  Eigen::MatrixXd means(2, 3);
  means << -3, 0, 4, 1, -2, 2;
  Eigen::Matrix2d a, b;
  a << 0.5, 0.3, 0.3, 0.4;
  b << 0.3, -0.2, -0.2, 0.6;
  return {Eigen::Vector3d(0.2, 0.3, 0.5), means, {a, b, 0.2 * Eigen::Matrix2d::Identity()}};
}

Eigen::MatrixXd draws_of(const Mixture& mixture, Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  std::discrete_distribution<Eigen::Index> component(mixture.weights().begin(),
                                                     mixture.weights().end());
  Eigen::MatrixXd draws(mixture.dimension(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index k = component(generator);
    const Eigen::VectorXd noise =
        Eigen::VectorXd::NullaryExpr(mixture.dimension(), [&] { return normal(generator); });
    draws.col(i) = mixture.means().col(k) +
                   mixture.covariances()[static_cast<std::size_t>(k)].llt().matrixL() * noise;
  }
  return draws;
}

FitSummary fit(const Eigen::MatrixXd& configurations, const FitOptions& options) {
  return fit_mixture(configurations, Eigen::VectorXd::Ones(configurations.cols()), options)
      .value_or_throw();
}

std::string refusal(const Eigen::MatrixXd& configurations, const Eigen::VectorXd& weights,
                    const FitOptions& options = {}) {
  const auto result = fit_mixture(configurations, weights, options);
  return result ? "accepted" : result.error().message;
}

TEST(FitMixture, RecoversAKnownMixture) {
  const Mixture known = known_mixture();
  const Mixture fitted = fit(draws_of(known, 20'000), {.components = 3, .tolerance = 1e-6}).mixture;
  ASSERT_EQ(fitted.size(), 3);
  for (Eigen::Index k = 0; k < 3; ++k) {
    Eigen::Index match = 0;
    (fitted.means().colwise() - known.means().col(k)).colwise().norm().minCoeff(&match);
    EXPECT_NEAR(fitted.weights()[match], known.weights()[k], 0.015);
    EXPECT_LT((fitted.means().col(match) - known.means().col(k)).norm(), 0.05);
    EXPECT_LT((fitted.covariances()[static_cast<std::size_t>(match)] -
               known.covariances()[static_cast<std::size_t>(k)])
                  .norm(),
              0.05);
  }
}

TEST(FitMixture, LastLogLikelihoodIsThatOfTheMixture) {
  const Eigen::MatrixXd configurations = draws_of(known_mixture(), 2000);
  const FitSummary summary = fit(configurations, {.components = 4});
  EXPECT_NEAR(summary.log_likelihoods.back(),
              kinship::mixture::log_density(summary.mixture, configurations).mean(), 1e-10);
}

TEST(FitMixture, SameSeedSameBytesAnotherSeedAnotherStart) {
  const Eigen::MatrixXd configurations = draws_of(known_mixture(), 3000);
  const Mixture first = fit(configurations, {.components = 8, .seed = 1}).mixture;
  const Mixture second = fit(configurations, {.components = 8, .seed = 1}).mixture;
  const Mixture other = fit(configurations, {.components = 8, .seed = 2}).mixture;
  EXPECT_EQ(first.means(), second.means());
  EXPECT_EQ(first.weights(), second.weights());
  EXPECT_EQ(first.covariances(), second.covariances());
  EXPECT_NE(first.means(), other.means());
}

TEST(FitMixture, ComponentsAreLimitedByTheDistinctConfigurations) {
  EXPECT_LE(fit(draws_of(known_mixture(), 60), {.components = 50}).mixture.size(), 10);
  const Eigen::MatrixXd repeated = draws_of(known_mixture(), 10).replicate(1, 100);
  EXPECT_EQ(fit(repeated, {.components = 50}).mixture.size(), 1);
  EXPECT_EQ(fit(draws_of(known_mixture(), 3), {.components = 50}).mixture.size(), 1);
}

TEST(FitMixture, AConstantJointGetsTheFloor) {
  Eigen::MatrixXd constant = draws_of(known_mixture(), 500);
  constant.row(1).setConstant(0.7);
  EXPECT_NEAR(fit(constant, {.components = 3}).mixture.covariances()[0](1, 1), 1e-4, 1e-12);
}

TEST(FitMixture, DegenerateConfigurationsWithoutFloorAreRefused) {
  Eigen::MatrixXd constant = draws_of(known_mixture(), 500);
  constant.row(1).setConstant(0.5);
  const std::string message =
      refusal(constant, Eigen::VectorXd::Ones(500), {.components = 3, .covariance_floor = 0});
  EXPECT_NE(message.find("covariance_floor 0 is too small"), std::string::npos) << message;
}

TEST(FitMixture, TooFewDistinctConfigurationsAreRefused) {
  EXPECT_EQ(refusal(Eigen::MatrixXd::Ones(2, 100), Eigen::VectorXd::Ones(100)),
            "fit: 1 distinct configurations, need at least 3 for 2 joints");
  EXPECT_EQ(refusal(Eigen::MatrixXd(2, 0), Eigen::VectorXd(0)),
            "fit: weights have sum 0.000000, must be positive and finite");
}

TEST(FitMixture, NumbersThatAreNoneAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd configurations = draws_of(known_mixture(), 100);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(100);
  for (const double bad : {nan, std::numeric_limits<double>::infinity(), -1e7}) {
    Eigen::MatrixXd damaged = configurations;
    damaged(1, 7) = bad;
    EXPECT_EQ(refusal(damaged, weights),
              "fit: configuration 7 is not finite or exceeds 1000000.000000");
  }
  for (const double bad : {nan, std::numeric_limits<double>::infinity(), -1.0}) {
    weights[3] = bad;
    EXPECT_NE(refusal(configurations, weights).find("fit: weight 3 is"), std::string::npos);
  }
  EXPECT_NE(refusal(configurations, Eigen::VectorXd::Zero(100)).find("sum"), std::string::npos);
}

TEST(FitMixture, OptionsOutsideTheirRangeAreACallersBug) {
  const Eigen::MatrixXd configurations = draws_of(known_mixture(), 100);
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(100);
  EXPECT_THROW(fit_mixture(configurations, weights.head(99), {}).has_value(),
               std::invalid_argument);
  EXPECT_THROW(fit_mixture(configurations, weights, {.components = -1}).has_value(),
               std::invalid_argument);
  EXPECT_THROW(fit_mixture(configurations, weights, {.covariance_floor = -1}).has_value(),
               std::invalid_argument);
}

}  // namespace
}  // namespace kinship::density::fit_test
