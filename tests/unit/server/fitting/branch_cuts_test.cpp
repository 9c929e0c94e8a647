#include "server/fitting/branch_cuts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "server/density/fit.hpp"
#include "tests/support/planar_arm.hpp"

namespace kinship::fitting::branch_cuts_test {
namespace {

constexpr std::uint64_t kSeed = 41;
constexpr double kTurn = 2 * std::numbers::pi;

kinematics::Chain turning_arm() {
  return test::PlanarArm{.lengths_m = {0.4, 0.3}, .type = kinematics::JointType::Continuous}
      .chain();
}

/// Angles around two places of the first joint, one of them +-pi; the second turns all around.
Eigen::MatrixXd straddling(Eigen::Index count) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal(0, 0.1);
  std::uniform_real_distribution<double> around(-std::numbers::pi, std::numbers::pi);
  Eigen::MatrixXd configurations(2, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double angle = (i % 2 == 0 ? std::numbers::pi : 1.5) + normal(generator);
    configurations.col(i) << std::remainder(angle, kTurn), around(generator);
  }
  return configurations;
}

TEST(BranchCuts, LieInTheLargestGap) {
  const BranchCuts cuts = find_cuts(turning_arm(), straddling(400));
  ASSERT_EQ(cuts.size(), 2U);
  EXPECT_NEAR(*cuts[0], -0.8, 0.2);  // the gap from pi back to 1.5 the long way round
  EXPECT_GE(*cuts[1], -std::numbers::pi);
  EXPECT_LT(*cuts[1], std::numbers::pi);
}

TEST(BranchCuts, OfJointsWithLimitsAreNone) {
  const kinematics::Chain arm = test::PlanarArm{.lengths_m = {0.4, 0.3}}.chain();
  EXPECT_TRUE(find_cuts(arm, straddling(10)).empty());
  EXPECT_EQ(limits_with({}, arm)(0, 1), arm.lower()[1]);
}

TEST(BranchCuts, WrappedAnglesLieBehindTheCutAndAreTheSame) {
  const Eigen::MatrixXd before = straddling(400);
  const BranchCuts cuts = find_cuts(turning_arm(), before);
  Eigen::MatrixXd after = before;
  wrap(cuts, after);
  const Eigen::Matrix2Xd limits = limits_with(cuts, turning_arm());
  EXPECT_NEAR(limits(1, 0) - limits(0, 0), kTurn, 1e-15);
  for (Eigen::Index i = 0; i < after.cols(); ++i)
    for (Eigen::Index joint = 0; joint < 2; ++joint) {
      EXPECT_GE(after(joint, i), limits(0, joint));
      EXPECT_LT(after(joint, i), limits(1, joint));
      EXPECT_NEAR(std::remainder(after(joint, i) - before(joint, i), kTurn), 0, 1e-12);
    }
  EXPECT_GT(after.row(0).minCoeff(), 1);  // both places on one side of the cut, in one piece
  EXPECT_LT(after.row(0).maxCoeff(), 4);
}

TEST(BranchCuts, OnePlaceIsCutOppositeOfIt) {
  for (const double place : {0.0, 1.0, 3.1, -3.1}) {
    const Eigen::MatrixXd same = Eigen::MatrixXd::Constant(2, 3, place);
    EXPECT_NEAR(std::abs(std::remainder(*find_cuts(turning_arm(), same)[0] - place, kTurn)),
                std::numbers::pi, 1e-12);
  }
}

TEST(BranchCuts, AnEarlierCutHoldsWhileItsGapIsWide) {
  Eigen::MatrixXd angles = Eigen::MatrixXd::Zero(2, 3);
  angles.row(0) << -0.5, 0, 0.5;
  const BranchCuts cuts = find_cuts(turning_arm(), angles);  // opposite of 0
  EXPECT_TRUE(still_cuts(cuts, turning_arm(), angles));
  angles.row(0) << -0.5, 0, 2;  // the gap around pi is smaller now, and still the largest
  EXPECT_TRUE(still_cuts(cuts, turning_arm(), angles));
  angles.row(0) << -3.0, 0, 3.0;  // the cut is in a gap of 0.28, others are ten times as wide
  EXPECT_FALSE(still_cuts(cuts, turning_arm(), angles));
  angles.row(0).array() += kTurn;
  EXPECT_FALSE(still_cuts(cuts, turning_arm(), angles));
  EXPECT_FALSE(still_cuts({}, turning_arm(), angles));
}

TEST(BranchCuts, FullTurnsChangeNothing) {
  const Eigen::MatrixXd configurations = straddling(600);
  const Eigen::MatrixXd turned = configurations.array() + kTurn;
  const auto fitted = [](Eigen::MatrixXd angles) {
    const BranchCuts cuts = find_cuts(turning_arm(), angles);
    wrap(cuts, angles);
    density::FitOptions options;
    options.components = 4;
    return density::fit_mixture(angles, Eigen::VectorXd::Ones(angles.cols()), options)
        .value_or_throw()
        .mixture;
  };
  const Mixture here = fitted(configurations);
  const Mixture there = fitted(turned);
  ASSERT_EQ(here.size(), there.size());
  EXPECT_LT((here.means() - there.means()).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((here.weights() - there.weights()).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace kinship::fitting::branch_cuts_test
