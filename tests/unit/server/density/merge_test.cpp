#include "server/density/merge.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <limits>
#include <random>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::density::merge_test {
namespace {

constexpr std::uint64_t kSeed = 29;

Mixture random_mixture(Eigen::Index dimension, Eigen::Index components) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(generator); };
  Eigen::VectorXd weights =
      Eigen::VectorXd::NullaryExpr(components, [&] { return 0.1 + std::abs(normal(generator)); });
  weights /= weights.sum();
  std::vector<Eigen::MatrixXd> covariances;
  for (Eigen::Index k = 0; k < components; ++k) {
    const Eigen::MatrixXd factor = Eigen::MatrixXd::NullaryExpr(dimension, dimension, draw);
    covariances.emplace_back(factor * factor.transpose() +
                             0.1 * Eigen::MatrixXd::Identity(dimension, dimension));
  }
  return {weights, 3 * Eigen::MatrixXd::NullaryExpr(dimension, components, draw), covariances};
}

std::pair<Eigen::VectorXd, Eigen::MatrixXd> mean_and_covariance(const Mixture& mixture) {
  const Eigen::VectorXd mean = mixture.means() * mixture.weights();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(mean.size(), mean.size());
  for (Eigen::Index k = 0; k < mixture.size(); ++k) {
    const Eigen::VectorXd offset = mixture.means().col(k) - mean;
    covariance += mixture.weights()[k] * (mixture.covariances()[static_cast<std::size_t>(k)] +
                                          offset * offset.transpose());
  }
  return {mean, covariance};
}

TEST(Merged, KeepsTotalMeanAndCovariance) {
  const Mixture mixture = random_mixture(4, 30);
  const auto [mean, covariance] = mean_and_covariance(mixture);
  for (const Eigen::Index components : {29, 12, 3, 1}) {
    const Mixture fewer = merged(mixture, components);
    ASSERT_EQ(fewer.size(), components);
    const auto [merged_mean, merged_covariance] = mean_and_covariance(fewer);
    EXPECT_LT((merged_mean - mean).norm(), 1e-12);
    EXPECT_LT((merged_covariance - covariance).norm(), 1e-11);
    EXPECT_NEAR(fewer.weights().sum(), 1, 1e-12);
  }
}

/// Components without weight, a billion times heavier than others, and far away.
TEST(Merged, KeepsTotalMeanAndCovarianceOfNastyMixtures) {
  const Mixture usual = random_mixture(3, 20);
  Eigen::VectorXd weights = usual.weights();
  weights[2] = weights[7] = 0;
  weights[11] = 1e9;
  weights /= weights.sum();
  Eigen::MatrixXd means = usual.means();
  means.col(5).setConstant(1e4);
  means.col(7) = means.col(2);
  const Mixture mixture(weights, means, usual.covariances());
  const auto [mean, covariance] = mean_and_covariance(mixture);
  for (const Eigen::Index components : {15, 4, 1}) {
    const auto [merged_mean, merged_covariance] = mean_and_covariance(merged(mixture, components));
    EXPECT_LT((merged_mean - mean).norm(), 1e-11);
    EXPECT_LT((merged_covariance - covariance).norm(), 1e-9 * (1 + covariance.norm()));
  }
}

/// Two groups so far apart that what unites them has no Cholesky factor: within groups it has.
TEST(Merged, APairThatRoundingLeavesNoFactorIsMergedLast) {
  constexpr double kApart = 1.0 / 1024;
  Eigen::MatrixXd means(2, 4);
  means << 0, 1e6, kApart, 1e6 + kApart,  //
      0, 1e6, 0, 1e6;
  const Mixture mixture(Eigen::Vector4d::Constant(0.25), means,
                        {1e-6 * Eigen::Matrix2d::Identity()});
  const Mixture two = merged(mixture, 2);
  EXPECT_NEAR(two.means().row(1).minCoeff(), 0, 1e-9);
  EXPECT_NEAR(two.means().row(1).maxCoeff(), 1e6, 1e-9);
  EXPECT_THROW(static_cast<void>(merged(mixture, 1)), Failure);
}

TEST(Merged, EachStepTakesTheCheapestPairOfAll) {
  Mixture mixture = random_mixture(2, 12);
  const auto log_determinant = [](const Eigen::MatrixXd& covariance) {
    return std::log(covariance.determinant());
  };
  while (mixture.size() > 1) {
    double least = std::numeric_limits<double>::infinity();
    Eigen::VectorXd expected;  // weight of the pair, at the mean it will have
    for (Eigen::Index i = 0; i < mixture.size(); ++i)
      for (Eigen::Index j = i + 1; j < mixture.size(); ++j) {
        const double wi = mixture.weights()[i], wj = mixture.weights()[j];
        const Eigen::VectorXd offset = mixture.means().col(i) - mixture.means().col(j);
        const Eigen::MatrixXd& ci = mixture.covariances()[static_cast<std::size_t>(i)];
        const Eigen::MatrixXd& cj = mixture.covariances()[static_cast<std::size_t>(j)];
        const double w = wi + wj;
        const Eigen::MatrixXd pair =
            (wi * ci + wj * cj) / w + wi * wj / (w * w) * offset * offset.transpose();
        const double cost =
            (w * log_determinant(pair) - wi * log_determinant(ci) - wj * log_determinant(cj)) / 2;
        if (cost >= least)
          continue;
        least = cost;
        expected = (wi * mixture.means().col(i) + wj * mixture.means().col(j)) / w;
      }
    const Mixture next = merged(mixture, mixture.size() - 1);
    EXPECT_LT((next.means().colwise() - expected).colwise().norm().minCoeff(), 1e-12);
    mixture = next;
  }
}

TEST(Merged, ManyStepsAreTheSameAsOneAfterTheOther) {
  const Mixture mixture = random_mixture(3, 40);
  Mixture stepwise = mixture;
  for (Eigen::Index components = 39; components >= 5; --components)
    stepwise = merged(stepwise, components);
  const Mixture at_once = merged(mixture, 5);
  for (Eigen::Index k = 0; k < 5; ++k)
    EXPECT_LT((stepwise.means().colwise() - at_once.means().col(k)).colwise().norm().minCoeff(),
              1e-9);
}

TEST(Merged, FewEnoughStayAsTheyAre) {
  const Mixture mixture = random_mixture(3, 5);
  EXPECT_EQ(merged(mixture, 5).means(), mixture.means());
  EXPECT_EQ(merged(mixture, 9).size(), 5);
}

}  // namespace
}  // namespace kinship::density::merge_test
