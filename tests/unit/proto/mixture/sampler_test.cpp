#include "proto/mixture/sampler.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/failure.hpp"

namespace kinship::mixture::sampler_test {
namespace {

constexpr std::uint64_t kSeed = 11;

Mixture tilted_2d() {
  Eigen::MatrixXd means(2, 2);
  means << -1, 2, 0.5, 0;
  Eigen::Matrix2d first;
  first << 0.5, 0.3, 0.3, 0.4;
  Eigen::Matrix2d second;
  second << 0.2, -0.1, -0.1, 0.3;
  return {Eigen::Vector2d(0.3, 0.7), means, {first, second}};
}

Eigen::Matrix2Xd limits_of(double lower, double upper, Eigen::Index dimension) {
  Eigen::Matrix2Xd limits(2, dimension);
  limits.row(0).setConstant(lower);
  limits.row(1).setConstant(upper);
  return limits;
}

Eigen::MatrixXd draw(const Sampler& sampler, Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  Eigen::MatrixXd samples(sampler.dimension(), count);
  for (Eigen::Index i = 0; i < count; ++i)
    samples.col(i) = sampler.sample(generator).value();
  return samples;
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& samples) {
  const Eigen::MatrixXd centred = samples.colwise() - samples.rowwise().mean();
  return centred * centred.transpose() / static_cast<double>(samples.cols());
}

/// One covariance for all is the same as one each.
TEST(Sampler, SharedCovarianceDrawsTheSame) {
  const Mixture apart = tilted_2d();
  const Eigen::MatrixXd& covariance = apart.covariance(1);
  const Mixture shared(apart.weights(), apart.means(), {covariance});
  const Mixture repeated(apart.weights(), apart.means(), {covariance, covariance});
  ASSERT_TRUE(shared.shares_covariance());
  EXPECT_EQ(draw(Sampler(shared, limits_of(-2, 2, 2)), 1000),
            draw(Sampler(repeated, limits_of(-2, 2, 2)), 1000));
}

TEST(Sampler, MeanAndCovarianceMatchIfLimitsAreWide) {
  const Mixture mixture = tilted_2d();
  const Eigen::MatrixXd samples = draw(Sampler(mixture, limits_of(-100, 100, 2)), 200'000);
  const Eigen::Vector2d mean = mixture.means() * mixture.weights();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Eigen::Vector2d offset = mixture.means().col(k) - mean;
    covariance += mixture.weights()[k] * (mixture.covariances()[static_cast<std::size_t>(k)] +
                                          offset * offset.transpose());
  }
  EXPECT_LT((samples.rowwise().mean() - mean).cwiseAbs().maxCoeff(), 0.015);  // 4 sigma of 200 000
  EXPECT_LT((covariance_of(samples) - covariance).cwiseAbs().maxCoeff(), 0.03);
}

TEST(Sampler, EverySampleIsInsideTheLimits) {
  const Eigen::MatrixXd samples = draw(Sampler(tilted_2d(), limits_of(-1.2, 0.7, 2)), 20'000);
  EXPECT_GE(samples.minCoeff(), -1.2);
  EXPECT_LE(samples.maxCoeff(), 0.7);
}

TEST(Sampler, LimitsChangeTheSharesOfComponents) {
  // Half of N(0, 1) lies above 0 and all of N(20, 1): (0.5 0.5) / (0.5 0.5 + 0.5) = 1/3.
  Eigen::MatrixXd means(1, 2);
  means << 0, 20;
  const Mixture mixture(Eigen::Vector2d(0.5, 0.5), means,
                        {Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd::Ones(1, 1)});
  const Eigen::MatrixXd samples = draw(Sampler(mixture, limits_of(0, 100, 1)), 100'000);
  const double share = (samples.array() < 10).cast<double>().mean();
  EXPECT_NEAR(share, 1.0 / 3.0, 0.006);  // 4 sigma
}

TEST(Sampler, TruncatedDrawsMatchARejectionReference) {
  const Mixture mixture = tilted_2d();
  const Eigen::Matrix2Xd limits = limits_of(-1.5, 1.5, 2);
  const Eigen::MatrixXd samples = draw(Sampler(mixture, limits), 100'000);

  std::mt19937_64 generator(kSeed + 1);
  std::normal_distribution<double> normal;
  std::discrete_distribution<std::size_t> component({0.3, 0.7});
  Eigen::MatrixXd reference(2, samples.cols());
  for (Eigen::Index i = 0; i < reference.cols();) {
    const std::size_t k = component(generator);
    const Eigen::Vector2d noise(normal(generator), normal(generator));
    const Eigen::Vector2d q = mixture.means().col(static_cast<Eigen::Index>(k)) +
                              mixture.covariances()[k].llt().matrixL() * noise;
    if (q.cwiseAbs().maxCoeff() <= 1.5)
      reference.col(i++) = q;
  }

  EXPECT_LT((samples.rowwise().mean() - reference.rowwise().mean()).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_LT((covariance_of(samples) - covariance_of(reference)).cwiseAbs().maxCoeff(), 0.03);
}

TEST(Sampler, MixtureOutsideTheLimitsGivesNothing) {
  std::mt19937_64 generator(kSeed);
  const Sampler sampler(tilted_2d(), limits_of(50, 60, 2));
  EXPECT_FALSE(sampler.sample(generator));
  EXPECT_EQ(sampler.sample(generator, 10).cols(), 0);
}

/// How many samples lie in each of 6 x 6 equal bins of the square of 1.5.
Eigen::ArrayXXd counts_in_bins(const Eigen::MatrixXd& samples) {
  constexpr double kBinsPerUnit = 2;
  Eigen::ArrayXXd counts = Eigen::ArrayXXd::Zero(6, 6);
  for (const auto& q : samples.colwise())
    ++counts(static_cast<Eigen::Index>((q[0] + 1.5) * kBinsPerUnit),
             static_cast<Eigen::Index>((q[1] + 1.5) * kBinsPerUnit));
  return counts;
}

/// Two samples of one law: chi-squared of the 36 bins is below 66.6 in 999 of 1000 pairs.
TEST(Sampler, ManyAtOnceFollowTheSameLaw) {
  const Sampler sampler(tilted_2d(), limits_of(-1.499, 1.499, 2));
  const Eigen::MatrixXd one_by_one = draw(sampler, 200'000);
  std::mt19937_64 generator(kSeed + 1);
  const Eigen::MatrixXd at_once = sampler.sample(generator, one_by_one.cols());
  ASSERT_EQ(at_once.cols(), one_by_one.cols());
  EXPECT_LE(at_once.cwiseAbs().maxCoeff(), 1.499);
  const Eigen::ArrayXXd a = counts_in_bins(one_by_one), b = counts_in_bins(at_once);
  EXPECT_LT(((a - b).square() / (a + b).max(1)).sum(), 66.6);
  EXPECT_LT((covariance_of(at_once) - covariance_of(one_by_one)).cwiseAbs().maxCoeff(), 0.01);
}

/// Five and nine joints end in the middle of a block of rows.
TEST(Sampler, EveryJointHasItsVariance) {
  for (const Eigen::Index dimension : {1, 4, 5, 9}) {
    Eigen::MatrixXd factor = Eigen::MatrixXd::Identity(dimension, dimension);
    factor.col(0).setConstant(0.5);  // all follow the first
    const Mixture mixture(Eigen::VectorXd::Ones(1), Eigen::MatrixXd::Zero(dimension, 1),
                          {factor * factor.transpose()});
    std::mt19937_64 generator(kSeed);
    const Eigen::MatrixXd samples =
        Sampler(mixture, limits_of(-100, 100, dimension)).sample(generator, 100'000);
    EXPECT_LT((covariance_of(samples) - mixture.covariance(0)).cwiseAbs().maxCoeff(), 0.03)
        << dimension;
  }
}

TEST(Sampler, JointWithEqualLimitsIsMetOnlyByChance) {
  Eigen::Matrix2Xd limits = limits_of(-10, 10, 2);
  limits(0, 1) = limits(1, 1) = 0.25;
  std::mt19937_64 generator(kSeed);
  EXPECT_FALSE(Sampler(tilted_2d(), limits).sample(generator));
}

TEST(Sampler, SameSeedSameBytes) {
  const Sampler sampler(tilted_2d(), limits_of(-3, 3, 2));
  const Eigen::MatrixXd first = draw(sampler, 1000);
  EXPECT_EQ(first, draw(Sampler(tilted_2d(), limits_of(-3, 3, 2)), 1000));
  std::mt19937_64 one(kSeed), other(kSeed);
  EXPECT_EQ(sampler.sample(one, 1000), sampler.sample(other, 1000));
  EXPECT_NE(sampler.sample(one, 1000), first);
}

TEST(Sampler, ComponentWithoutWeightIsNeverDrawn) {
  const Mixture both = tilted_2d();
  for (const Eigen::Vector2d& weights : {Eigen::Vector2d(0, 1), Eigen::Vector2d(1, 0)}) {
    Eigen::MatrixXd means = both.means();
    means.col(weights[0] == 0 ? 0 : 1).setConstant(1000);
    const Mixture mixture(weights, means, both.covariances());
    EXPECT_LT(draw(Sampler(mixture, limits_of(-1e6, 1e6, 2)), 20'000).maxCoeff(), 100);
  }
}

TEST(Sampler, RefusesLimitsThatMakeNoSense) {
  EXPECT_THROW(Sampler(tilted_2d(), limits_of(-1, 1, 3)), std::invalid_argument);
  EXPECT_THROW(Sampler(tilted_2d(), limits_of(1, -1, 2)), std::invalid_argument);
  EXPECT_THROW(Sampler(tilted_2d(), limits_of(std::numeric_limits<double>::quiet_NaN(), 1, 2)),
               std::invalid_argument);
}

TEST(Sampler, RefusesACovarianceThatIsNotPositiveDefinite) {
  const Mixture flat(Eigen::VectorXd::Ones(1), Eigen::MatrixXd::Zero(2, 1),
                     {Eigen::Matrix2d::Zero()});
  EXPECT_THROW(Sampler(flat, limits_of(-1, 1, 2)), Failure);
}

/// A continuous joint, cut at 0, about half a turn, beside one that has limits.
Distribution turning_distribution() {
  Distribution distribution;
  distribution.mixture.emplace(Eigen::VectorXd::Ones(1), Eigen::Vector2d(std::numbers::pi, 0.4),
                               std::vector<Eigen::MatrixXd>{Eigen::Matrix2d::Identity()});
  distribution.limits.resize(2, 2);
  distribution.limits << 0, -0.5, 2 * std::numbers::pi, 0.5;
  distribution.cuts = {0.0, std::nullopt};
  return distribution;
}

TEST(DistributionSampler, ManyAtOnceTurnContinuousJointsAndKeepLimitsOfOthers) {
  const DistributionSampler sampler(turning_distribution());
  std::mt19937_64 generator(3);
  const Eigen::MatrixXd drawn = sampler.sample(generator, 2000);
  ASSERT_EQ(drawn.cols(), 2000);
  EXPECT_LE(drawn.row(0).cwiseAbs().maxCoeff(), std::numbers::pi);
  EXPECT_LE(drawn.row(1).cwiseAbs().maxCoeff(), 0.5);
  // About half a turn lies on both sides of where angles begin anew.
  EXPECT_NEAR((drawn.row(0).array() > 0).cast<double>().mean(), 0.5, 0.05);
  EXPECT_GT(drawn.row(0).cwiseAbs().mean(), 2);
}

}  // namespace
}  // namespace kinship::mixture::sampler_test
