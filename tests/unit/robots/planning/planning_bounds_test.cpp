#include "robots/planning/planning_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

namespace kinship::planning::planning_bounds_test {
namespace {

using kinematics::JointType;
using test::PlanarArm;

constexpr std::uint64_t kSeed = 8;

kinematics::Chain arm(double limit, JointType type = JointType::Revolute) {
  PlanarArm arm;
  arm.lengths_m = {0.4, 0.3};
  arm.limit = limit;
  arm.type = type;
  return arm.chain();
}

void expect_bounds(const Eigen::Matrix2Xd& bounds, Eigen::Index joint, double lower, double upper) {
  EXPECT_NEAR(bounds(0, joint), lower, 1e-12);
  EXPECT_NEAR(bounds(1, joint), upper, 1e-12);
}

TEST(PlanningBounds, AreTheLimitsOfJointsUpToATurn) {
  const auto bounds = planning_bounds(arm(M_PI), Eigen::Vector2d(1, -3));
  expect_bounds(bounds, 0, -M_PI, M_PI);
  expect_bounds(bounds, 1, -M_PI, M_PI);
}

TEST(PlanningBounds, OfWideJointsAreOneTurnAroundTheStartOrUpToALimit) {
  const auto bounds = planning_bounds(arm(2 * M_PI), Eigen::Vector2d(0.5, 1.5 * M_PI));
  expect_bounds(bounds, 0, 0.5 - M_PI, 0.5 + M_PI);
  expect_bounds(bounds, 1, 0, 2 * M_PI);
  const auto other = planning_bounds(arm(2 * M_PI), Eigen::Vector2d(-2 * M_PI, M_PI));
  expect_bounds(other, 0, -2 * M_PI, 0);
  expect_bounds(other, 1, 0, 2 * M_PI);
}

TEST(PlanningBounds, HoldEveryPostureOfAWideJointWhereverTheStartIs) {
  std::mt19937_64 generator(kSeed);
  for (const double limit : {M_PI + 0.01, 3.5, 2 * M_PI, 9.0}) {
    std::uniform_real_distribution<double> angle(-limit, limit);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d start(angle(generator), angle(generator));
      const auto bounds = planning_bounds(arm(limit), start);
      EXPECT_GE(bounds.minCoeff(), -limit - 1e-12);
      EXPECT_LE(bounds.maxCoeff(), limit + 1e-12);
      EXPECT_EQ(turned_into(bounds, {true, true}, start), start);
      EXPECT_TRUE(
          turned_into(bounds, {true, true}, Eigen::Vector2d(angle(generator), angle(generator))));
    }
  }
}

TEST(PlanningBounds, OfAUr10eAreATurnAroundTheStartButForItsElbow) {
  const auto chain = test::model_chain("ur10e");
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(6, 1.0);
  const auto bounds = planning_bounds(chain, start);
  for (Eigen::Index joint = 0; joint < 6; ++joint) {
    const double center = joint == 2 ? 0 : 1;  // the elbow turns half as far
    expect_bounds(bounds, joint, center - M_PI, center + M_PI);
  }
  EXPECT_EQ(turning_joints(chain), (std::vector<bool>{true, true, false, true, true, true}));
}

TEST(PlanningBounds, OfContinuousJointsAreHalfATurnAroundTheStartWhereverThatIs) {
  const auto bounds = planning_bounds(arm(M_PI, JointType::Continuous), Eigen::Vector2d(3, -20));
  expect_bounds(bounds, 0, 3 - M_PI, 3 + M_PI);
  expect_bounds(bounds, 1, -20 - M_PI, -20 + M_PI);
}

TEST(PlanningBounds, OfLongPrismaticJointsAreTheirLimits) {
  const auto chain = arm(8, JointType::Prismatic);
  expect_bounds(planning_bounds(chain, Eigen::Vector2d(1, 2)), 0, -8, 8);
  EXPECT_EQ(turning_joints(chain), (std::vector<bool>{false, false}));
}

TEST(PlanningBounds, RefusesAStartThatIsNone) {
  EXPECT_THROW(planning_bounds(arm(1), Eigen::Vector3d(0, 0, 0)), std::invalid_argument);
  EXPECT_THROW(planning_bounds(arm(1), Eigen::Vector2d(0, NAN)), std::invalid_argument);
}

TEST(TurnedInto, MovesByFullTurnsIntoBoundsOfATurn) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> angle(-30, 30);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d start(angle(generator), angle(generator));
    const Eigen::Vector2d q(angle(generator), angle(generator));
    const auto bounds = planning_bounds(arm(M_PI, JointType::Continuous), start);
    const auto turned = turned_into(bounds, {true, true}, q);
    ASSERT_TRUE(turned);
    for (Eigen::Index joint = 0; joint < 2; ++joint) {
      EXPECT_GE((*turned)[joint], bounds(0, joint));
      EXPECT_LE((*turned)[joint], bounds(1, joint));
      const double turns = ((*turned)[joint] - q[joint]) / (2 * M_PI);
      EXPECT_NEAR(turns, std::round(turns), 1e-9);
    }
  }
}

TEST(TurnedInto, IsEmptyWhereNoTurnLiesWithin) {
  Eigen::Matrix2Xd bounds(2, 2);
  bounds << -1, -1, 1, 1;
  EXPECT_FALSE(turned_into(bounds, {true, true}, Eigen::Vector2d(0, M_PI)));
  EXPECT_TRUE(turned_into(bounds, {true, true}, Eigen::Vector2d(0, 2 * M_PI - 0.5)));
}

TEST(TurnedInto, LeavesWhatLiesWithinAndNeverTurnsOtherJoints) {
  Eigen::Matrix2Xd bounds(2, 2);
  bounds << -M_PI, -3, M_PI, 3;
  EXPECT_EQ(turned_into(bounds, {true, false}, Eigen::Vector2d(1, 2)), Eigen::Vector2d(1, 2));
  EXPECT_FALSE(turned_into(bounds, {true, false}, Eigen::Vector2d(1, 2 + 2 * M_PI)));
}

TEST(TurnedInto, OfManyThoseAreLeftThatHaveATurnThere) {
  const kinematics::Chain chain = arm(M_PI, JointType::Continuous);
  Eigen::Matrix2Xd bounds(2, 2);
  bounds << -1, -1, 1, 1;
  Eigen::MatrixXd qs(2, 3);
  qs << 0, 0, 2 * M_PI, 0.5, M_PI, 0;
  Eigen::MatrixXd left(2, 2);
  left << 0, 0, 0.5, 0;
  EXPECT_TRUE(all_turned_into(bounds, chain, qs).isApprox(left, 1e-12));
}

}  // namespace
}  // namespace kinship::planning::planning_bounds_test
