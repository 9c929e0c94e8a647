#include "proto/mixture/distribution_sampler.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace kinship::mixture::distribution_sampler_test {
namespace {

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
}  // namespace kinship::mixture::distribution_sampler_test
