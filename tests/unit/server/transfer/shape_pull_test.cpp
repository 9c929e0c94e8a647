#include "server/transfer/shape_pull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "proto/types/profile.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "server/transfer/shape_lanes.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

namespace kinship::transfer::shape_pull_test {
namespace {

using test::PlanarArm;

const PlanarArm kRedundant{.lengths_m = {0.18, 0.17, 0.16, 0.15, 0.13, 0.11, 0.1}, .limit = 2.8};

std::vector<int> all_lanes() {
  std::vector<int> lanes(static_cast<std::size_t>(ShapeLanes::kCount));
  std::iota(lanes.begin(), lanes.end(), 0);
  return lanes;
}

/// Lets some lanes make a pull, with all that follows from it.
void pull_lanes(ShapeLanes& lanes, const std::vector<int>& some, int steps) {
  for (const int lane : some)
    lanes.begin_pull(lane, steps);
  while (lanes.run())
    for (const int lane : all_lanes())
      if (lanes.has_ended(lane))
        lanes.rest(lane);
}

/// The same for one posture alone.
/// \return how far the shapes are apart at the end, m.
double pull_to_shape(const ArmPair& pair, const Eigen::Isometry3d& T_base_transfer,
                     const ArmShape& wanted, int steps, inverse::JointVector& q) {
  ShapeLanes lanes(pair);
  lanes.aim(0, T_base_transfer, wanted);
  lanes.put(0, q);
  pull_lanes(lanes, {0}, steps);
  q = lanes.at(0);
  return shape_distance(arm_shape(pair.target(), q), wanted);
}

/// Two postures of an arm at the same pose: `q` is where a pull starts, `wanted` what it goes to.
struct Pull {
  kinematics::Chain arm = kRedundant.chain();
  ArmPair pair{arm, arm};
  inverse::JointVector q = inverse::JointVector::Constant(7, 0.1);
  Eigen::Isometry3d T_base_transfer;
  ArmShape wanted;

  Pull() {
    Eigen::VectorXd posture(7);
    posture << 0.9, -0.6, -0.7, 0.4, 0.5, -0.3, 0.2;
    T_base_transfer = kinematics::T_base_transfer(arm, posture);
    wanted = arm_shape(arm, posture);
    pair.target_descent().run(T_base_transfer, inverse::Descent::Limits::Hold, 50, q);
  }

  double distance() const { return shape_distance(arm_shape(arm, q), wanted); }
};

TEST(PullToShape, BringsTheArmToTheShapeAndLeavesThePose) {
  Pull pull;
  ASSERT_TRUE(inverse::reaches(pull.arm, pull.T_base_transfer, pull.q));
  const double before = pull.distance();
  ASSERT_GT(before, 0.1);
  const double after = pull_to_shape(pull.pair, pull.T_base_transfer, pull.wanted, 30, pull.q);
  EXPECT_DOUBLE_EQ(after, pull.distance());
  EXPECT_LT(after, 0.1 * before);
  EXPECT_TRUE(inverse::reaches(pull.arm, pull.T_base_transfer, pull.q));
  EXPECT_TRUE(pull.arm.within_limits(pull.q));
}

TEST(PullToShape, EveryFurtherStepComesNearer) {
  double before = Pull().distance();
  for (const int steps : {1, 2, 3, 4}) {
    Pull pull;
    const double after = pull_to_shape(pull.pair, pull.T_base_transfer, pull.wanted, steps, pull.q);
    EXPECT_LT(after, before) << steps;
    before = after;
  }
}

TEST(PullToShape, WithoutStepsNothingMoves) {
  Pull pull;
  const inverse::JointVector start = pull.q;
  EXPECT_DOUBLE_EQ(pull_to_shape(pull.pair, pull.T_base_transfer, pull.wanted, 0, pull.q),
                   pull.distance());
  EXPECT_EQ(pull.q, start);
}

TEST(PullToShape, StaysWithinNarrowLimits) {
  PlanarArm narrow = kRedundant;
  narrow.limit = 0.8;  // the posture that is wanted bends by 0.9
  Pull pull;
  const kinematics::Chain arm = narrow.chain();
  const ArmPair pair(arm, arm);
  ASSERT_TRUE(arm.within_limits(pull.q));
  const double before = pull.distance();
  EXPECT_LT(pull_to_shape(pair, pull.T_base_transfer, pull.wanted, 30, pull.q), before);
  EXPECT_TRUE(arm.within_limits(pull.q));
  EXPECT_TRUE(inverse::reaches(arm, pull.T_base_transfer, pull.q));
}

TEST(PullToShape, AnArmWithoutSelfMotionStaysWhereItIs) {
  const kinematics::Chain arm = test::model_chain("ur10e");
  const ArmPair pair(arm, arm);
  inverse::JointVector q(6);
  q << 0.3, -1.2, 1.4, -0.5, 1.1, 0.2;
  const inverse::JointVector start = q;
  const Eigen::Isometry3d T_base_transfer = kinematics::T_base_transfer(arm, q);
  ArmShape wanted = arm_shape(arm, q);
  wanted.row(2).array() += 0.1;
  pull_to_shape(pair, T_base_transfer, wanted, 5, q);
  EXPECT_LT((q - start).norm(), 1e-3);
}

/// As many postures as there are lanes give what each would give alone by the other way.
TEST(ShapeLanes, EveryLaneIsPulledAsOneAloneIs) {
  for (const char* model : {"panda", "iiwa14", "planar_7r_c"}) {
    const kinematics::Chain arm = test::model_chain(model);
    const ArmPair pair(arm, arm);
    ASSERT_TRUE(pair.target_marks());
    std::mt19937_64 generator(9);
    ShapeLanes lanes(pair);
    std::vector<ArmShape> wanted;
    std::vector<double> alone_m;
    for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
      inverse::JointVector q = test::random_configuration(arm, generator);
      wanted.push_back(arm_shape(arm, test::random_configuration(arm, generator)));
      const Eigen::Isometry3d T = kinematics::T_base_transfer(arm, q);
      lanes.aim(lane, T, wanted.back());
      lanes.put(lane, q);
      alone_m.push_back(pull_alone(pair, T, wanted.back(), 3, q));
    }
    pull_lanes(lanes, all_lanes(), 3);
    for (const int lane : all_lanes()) {
      const auto i = static_cast<std::size_t>(lane);
      EXPECT_NEAR(shape_distance(arm_shape(arm, lanes.at(lane)), wanted[i]), alone_m[i],
                  0.02 * alone_m[i])
          << model;
    }
  }
}

/// None, fewer configurations than lanes and more.
TEST(ShapeLanes, MeasureShapesAsOneAfterTheOther) {
  for (const char* model : {"panda", "ur10e", "planar_5r_a"}) {
    const kinematics::Chain arm = test::model_chain(model);
    const ArmPair pair(arm, arm);
    std::mt19937_64 generator(11);
    const ArmShape wanted = arm_shape(arm, test::random_configuration(arm, generator));
    for (const Eigen::Index count : {0, 1, 8, 11}) {
      Eigen::MatrixXd configurations(arm.dof(), count);
      for (Eigen::Index i = 0; i < count; ++i)
        configurations.col(i) = test::random_configuration(arm, generator);
      const Eigen::VectorXd distances_m = shape_distances_m(pair, configurations, wanted);
      ASSERT_EQ(distances_m.size(), count);
      for (Eigen::Index i = 0; i < count; ++i)
        EXPECT_NEAR(distances_m[i], shape_distance(arm_shape(arm, configurations.col(i)), wanted),
                    1e-12)
            << model;
    }
  }
}

/// A long pull towards a shape that is somewhere else.
TEST(ShapeLanes, EndAtTheirPosesWithinLimits) {
  for (const char* model : {"panda", "iiwa14", "planar_7r_c"}) {
    const kinematics::Chain arm = test::model_chain(model);
    const ArmPair pair(arm, arm);
    std::mt19937_64 generator(12);
    ShapeLanes lanes(pair);
    Eigen::MatrixXd q(arm.dof(), ShapeLanes::kCount);
    for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
      q.col(lane) = test::random_configuration(arm, generator);
      lanes.aim(lane, kinematics::T_base_transfer(arm, q.col(lane)),
                arm_shape(arm, test::random_configuration(arm, generator)));
      lanes.put(lane, q.col(lane));
    }
    pull_lanes(lanes, all_lanes(), 20);
    int moved = 0;
    for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
      moved += (lanes.at(lane) - q.col(lane)).norm() > 1e-3 ? 1 : 0;
      EXPECT_TRUE(arm.within_limits(lanes.at(lane), 1e-9)) << model;
      q.col(lane) = lanes.at(lane);
    }
    // Near a singular posture a descent may be too slow to settle: the lane stays where it was, or
    // is off by what a last step there leaves.
    constexpr int kSingular = ShapeLanes::kCount / 8;
    EXPECT_GE(moved, ShapeLanes::kCount - kSingular) << model;
    EXPECT_GE(std::ranges::count(lanes.verified(q), true), ShapeLanes::kCount - kSingular) << model;
  }
}

TEST(ShapeLanes, LanesThatAreNotAskedForStay) {
  Pull pull;
  ShapeLanes lanes(pull.pair);
  for (const int lane : {2, 5}) {
    lanes.aim(lane, pull.T_base_transfer, pull.wanted);
    lanes.put(lane, pull.q);
  }
  pull_lanes(lanes, {5}, 5);
  EXPECT_EQ(lanes.at(2), pull.q);
  EXPECT_GT((lanes.at(5) - pull.q).norm(), 0.01);
}

TEST(PullToShape, AnArmWithASlidingJointIsPulledToo) {
  const kinematics::Chain turning = kRedundant.chain();
  kinematics::ChainParts parts{turning.base_link(),  turning.tip_link(),       turning.joints(),
                               turning.T_last_tip(), turning.T_tip_transfer(), turning.task_axes(),
                               turning.links()};
  parts.joints[2].type = kinematics::JointType::Prismatic;
  const kinematics::Chain arm(parts);
  const ArmPair pair(arm, arm);
  EXPECT_FALSE(pair.target_marks());
  inverse::JointVector q = inverse::JointVector::Constant(7, 0.3);
  const Eigen::Isometry3d T = kinematics::T_base_transfer(arm, q);
  Eigen::VectorXd other = q;
  other[0] += 0.2;
  const ArmShape wanted = arm_shape(arm, other);
  const double before = shape_distance(arm_shape(arm, q), wanted);
  EXPECT_LT(pull_to_shape(pair, T, wanted, 5, q), before);
  EXPECT_TRUE(inverse::reaches(arm, T, q));
}

/// Central differences of shape and pose against the derivative.
void expect_derivative(const kinematics::Chain& arm, const Eigen::VectorXd& q) {
  constexpr double kStep = 1e-6;
  const ArmShapeMotion motion = arm_shape_motion(arm, q);
  EXPECT_EQ(motion.shape, arm_shape(arm, q));
  for (Eigen::Index j = 0; j < arm.dof(); ++j) {
    Eigen::VectorXd above = q, below = q;
    above[j] += kStep;
    below[j] -= kStep;
    const Eigen::VectorXd points =
        ((arm_shape(arm, above) - arm_shape(arm, below)) / (2 * kStep)).reshaped();
    EXPECT_LT((motion.J_points.col(j) - points).norm(), 1e-8) << "joint " << j;
    const inverse::TaskError pose =
        inverse::task_error(kinematics::T_base_transfer(arm, above),
                            kinematics::T_base_transfer(arm, below), TaskAxes{}) /
        (2 * kStep);
    EXPECT_LT((motion.J_pose.col(j) - pose).norm(), 1e-8) << "joint " << j;
  }
}

TEST(ArmShapeMotion, IsTheDerivative) {
  Eigen::VectorXd planar(7), panda(7);
  planar << 0.9, -0.6, -0.7, 0.4, 0.5, -0.3, 0.2;
  panda << 0.4, -0.5, 0.3, -1.8, 0.2, 1.5, 0.7;
  expect_derivative(kRedundant.chain(), planar);
  expect_derivative(test::model_chain("panda"), panda);
}

}  // namespace
}  // namespace kinship::transfer::shape_pull_test
