#include "robots/planning/guided_sampler.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/support/robots.hpp"

namespace kinship::planning::guidance_gate_test {
namespace {

constexpr double kTurn = 2 * M_PI;

constexpr double kVariance = 0.04;  // of each joint, widened

/// Two components of a UR10e, whose joints turn more than once.
Mixture two_components(const Eigen::VectorXd& first, const Eigen::VectorXd& second,
                       double variance = kVariance - kGateVariance) {
  Eigen::MatrixXd means(first.size(), 2);
  means << first, second;
  const Eigen::MatrixXd covariance = variance * Eigen::MatrixXd::Identity(6, 6);
  return Mixture(Eigen::Vector2d(0.99, 0.01), means, {covariance, covariance});
}

class GuidanceGate : public testing::Test {
 protected:
  const kinematics::Chain chain_ = test::model_chain("ur10e");
  const Eigen::VectorXd start_ = Eigen::VectorXd::Constant(6, 0.5);
  const Eigen::VectorXd goal_ = Eigen::VectorXd::Constant(6, -1);
  const Mixture mixture_ = two_components(start_, goal_);
};

TEST_F(GuidanceGate, DistanceIsToTheNearestComponentInItsOwnMetric) {
  Eigen::VectorXd near = start_;
  near[0] += 0.6;
  const QueryDistance distance = query_distance(chain_, mixture_, near, goal_);
  EXPECT_NEAR(distance.start, 9, 1e-9);
  EXPECT_NEAR(distance.goal, 0, 1e-9) << "the weight of a component does not matter";
}

/// The default profile's floor is (0.01 rad)^2: a third of a radian would be 1225 away.
TEST_F(GuidanceGate, ANarrowComponentIsNoWall) {
  Eigen::VectorXd near = start_;
  near[2] += 0.35;
  const QueryDistance distance =
      query_distance(chain_, two_components(start_, goal_, 1e-4), near, goal_);
  EXPECT_NEAR(distance.start, 0.35 * 0.35 / (1e-4 + kGateVariance), 1e-6);
  EXPECT_LT(distance.start, kGateDistance);
}

TEST_F(GuidanceGate, CorrelatedJointsAreWhitened) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(6, 6);
  covariance(0, 1) = covariance(1, 0) = 0.6;
  const Mixture mixture(Eigen::VectorXd::Ones(1), start_, {covariance});
  Eigen::VectorXd along = start_, across = start_;
  along[0] += 1;
  along[1] += 1;
  across[0] += 1;
  across[1] -= 1;
  EXPECT_NEAR(query_distance(chain_, mixture, along, goal_).start, 2 / (1.6 + kGateVariance), 1e-9);
  EXPECT_NEAR(query_distance(chain_, mixture, across, goal_).start, 2 / (0.4 + kGateVariance),
              1e-9);
}

TEST_F(GuidanceGate, KernelsShareTheirMetric) {
  Eigen::VectorXd near = start_;
  near[0] += 0.6;
  const Mixture kernels(mixture_.weights(), mixture_.means(), {mixture_.covariance(0)});
  EXPECT_EQ(query_distance(chain_, kernels, near, goal_).start,
            query_distance(chain_, mixture_, near, goal_).start);
  near = goal_;
  near[3] += 0.2;
  EXPECT_NEAR(query_distance(chain_, kernels, near, goal_).start, 1, 1e-9);
}

TEST_F(GuidanceGate, AFullTurnIsNoDistance) {
  Eigen::VectorXd turned = start_;
  turned[0] -= kTurn;
  turned[5] += kTurn;
  EXPECT_NEAR(query_distance(chain_, mixture_, turned, goal_).start, 0, 1e-9);
  turned[0] -= kTurn / 2;
  EXPECT_NEAR(query_distance(chain_, mixture_, turned, goal_).start, M_PI * M_PI / kVariance, 1e-6);
}

TEST_F(GuidanceGate, JointsThatDoNotTurnKnowNoTurn) {
  const kinematics::Chain panda = test::model_chain("panda");
  const Eigen::VectorXd middle = (panda.lower() + panda.upper()) / 2;
  const Mixture mixture(Eigen::VectorXd::Ones(1), middle,
                        {(1 - kGateVariance) * Eigen::MatrixXd::Identity(7, 7)});
  Eigen::VectorXd turned = middle;
  turned[0] += kTurn;
  EXPECT_NEAR(query_distance(panda, mixture, turned, middle).start, kTurn * kTurn, 1e-9);
}

TEST_F(GuidanceGate, OneGoalWithinReachIsEnough) {
  Eigen::MatrixXd goals(6, 2);
  goals.col(0).setConstant(3);
  goals.col(1) = goal_;
  EXPECT_LT(query_distance(chain_, mixture_, start_, goals).goal, kGateDistance);
  EXPECT_GT(query_distance(chain_, mixture_, start_, goals.leftCols(1)).goal, kGateDistance);
}

/// A mixture turned by half a turn about the base, as of a robot that was set up the wrong way.
TEST_F(GuidanceGate, ATurnedMixtureIsBeyond) {
  Eigen::VectorXd start = start_, goal = goal_;
  start[0] += M_PI;
  goal[0] += M_PI;
  const QueryDistance distance = query_distance(chain_, two_components(start, goal), start_, goal_);
  EXPECT_GT(distance.start, kGateDistance);
  EXPECT_GT(distance.goal, kGateDistance);
}

TEST_F(GuidanceGate, SizesMustFit) {
  EXPECT_THROW(query_distance(chain_, mixture_, Eigen::VectorXd::Zero(5), goal_),
               std::invalid_argument);
  EXPECT_THROW(query_distance(chain_, mixture_, start_, Eigen::MatrixXd::Zero(7, 1)),
               std::invalid_argument);
  EXPECT_THROW(query_distance(test::model_chain("panda"), mixture_, start_, goal_),
               std::invalid_argument);
}

TEST_F(GuidanceGate, WithoutAGoalNothingIsNear) {
  EXPECT_EQ(query_distance(chain_, mixture_, start_, Eigen::MatrixXd(6, 0)).goal,
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace kinship::planning::guidance_gate_test
