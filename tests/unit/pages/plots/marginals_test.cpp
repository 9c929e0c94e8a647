#include "pages/plots/distribution_plot.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <numeric>

#include "proto/types/failure.hpp"
#include "tests/unit/pages/plots/plot_values.hpp"

namespace kinship::plots::marginals_test {
namespace {

class Marginals : public testing::Test {
 protected:
  const kinematics::Chain chain_ = kinship::test::model_chain("panda");
  Distribution distribution_ = test::distribution_for("panda");
  Eigen::MatrixXd samples_ = (0.5 * (chain_.lower() + chain_.upper())).replicate(1, 10);
};

TEST_F(Marginals, CountEverySampleOnceBetweenTheLimits) {
  const auto marginals = marginals_of(distribution_, chain_, samples_);
  ASSERT_EQ(marginals.size(), 7U);
  for (std::size_t joint = 0; joint < marginals.size(); ++joint) {
    const Marginal& marginal = marginals[joint];
    EXPECT_EQ(marginal.joint, chain_.joints()[joint].name);
    EXPECT_EQ(marginal.lower, chain_.joints()[joint].lower);
    EXPECT_EQ(marginal.upper, chain_.joints()[joint].upper);
    EXPECT_FALSE(marginal.cut);
    ASSERT_EQ(marginal.counts.size(), kMarginalBins);
    EXPECT_EQ(std::accumulate(marginal.counts.begin(), marginal.counts.end(), std::size_t{0}), 10U);
    EXPECT_EQ(marginal.counts[kMarginalBins / 2 - 1] + marginal.counts[kMarginalBins / 2], 10U);
  }
}

TEST_F(Marginals, WhatLiesAtALimitIsInTheOutermostBin) {
  samples_.row(2).setConstant(chain_.upper()(2));
  samples_.row(4).setConstant(chain_.lower()(4) - 1e-12);
  const auto marginals = marginals_of(distribution_, chain_, samples_);
  EXPECT_EQ(marginals[2].counts.back(), 10U);
  EXPECT_EQ(marginals[4].counts.front(), 10U);
}

TEST_F(Marginals, OfAContinuousJointGoOnceAround) {
  distribution_.cuts.resize(7);
  distribution_.cuts[1] = 2.5;
  distribution_.cuts[3] = -2 * std::numbers::pi + 0.5;
  distribution_.limits.col(1) << 2.5, 2.5 + 2 * std::numbers::pi;
  samples_.row(1).setConstant(-std::numbers::pi);
  const auto marginals = marginals_of(distribution_, chain_, samples_);
  EXPECT_EQ(marginals[1].lower, -std::numbers::pi);
  EXPECT_EQ(marginals[1].upper, std::numbers::pi);
  EXPECT_EQ(marginals[1].cut, 2.5);
  EXPECT_NEAR(marginals[3].cut.value(), 0.5, 1e-12) << "turned into the range that is shown";
  EXPECT_EQ(marginals[1].counts.front(), 10U);
}

TEST_F(Marginals, OfAJointThatCannotMoveAreInTheMiddle) {
  distribution_.limits.col(2).setConstant(0.5);
  samples_.row(2).setConstant(0.5);
  EXPECT_EQ(marginals_of(distribution_, chain_, samples_)[2].counts[kMarginalBins / 2], 10U);
}

TEST_F(Marginals, LimitsThatAreNoRangeAreRefused) {
  const Eigen::Matrix2Xd fine = distribution_.limits;
  distribution_.limits(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(marginals_of(distribution_, chain_, samples_), Failure);
  distribution_.limits = fine;
  distribution_.limits.col(2).reverseInPlace();
  EXPECT_THROW(marginals_of(distribution_, chain_, samples_), Failure);
}

TEST_F(Marginals, OfAnotherRobotAreRefused) {
  EXPECT_THROW(marginals_of(distribution_, chain_, samples_.topRows(6)), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::plots::marginals_test
