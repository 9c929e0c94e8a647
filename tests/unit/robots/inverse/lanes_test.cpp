#include "robots/inverse/lane_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "robots/inverse/closed_form.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"

namespace kinship::inverse::lanes_test {
namespace {

constexpr std::uint64_t kSeed = 3;

/// Chains of one to ten joints, turning and sliding, of a millimetre to ten metres.
std::vector<kinematics::Chain> many_chains() {
  std::mt19937_64 generator(kSeed);
  std::vector<kinematics::Chain> chains;
  for (int joints = 1; joints <= 10; ++joints)
    for (const double length_m : {1e-3, 0.3, 10.0})
      chains.push_back(test::random_chain(
          {.joints = joints, .length_m = length_m, .sliding_share = 0.3}, generator));
  return chains;
}

double pose_value(const Eigen::Isometry3d& T, int i) {
  return i < 9 ? T(i / 3, i % 3) : T(i - 9, 3);
}

TEST(Lanes, EveryMachineKnowsAnInstructionSet) {
  ASSERT_FALSE(instruction_sets().empty());
  EXPECT_EQ(instruction_sets().front().name, "sse2");
}

TEST(Lanes, TheCheckMeasuresWhatForwardKinematicsSay) {
  std::mt19937_64 generator(kSeed);
  for (const kinematics::Chain& chain : many_chains())
    for (const InstructionSet& set : instruction_sets()) {
      const LaneArm arm = lane_arm(chain);
      LaneCheck check;
      Eigen::Matrix<double, 2, kLanes> expected;
      for (int lane = 0; lane < kLanes; ++lane) {
        const Eigen::VectorXd q = test::random_configuration(chain, generator);
        const Eigen::Isometry3d T =
            kinematics::T_base_transfer(chain, test::random_configuration(chain, generator));
        const TaskError error =
            task_error(T, kinematics::T_base_transfer(chain, q), chain.task_axes());
        expected.col(lane) << error.head<3>().norm(), error.tail<3>().norm();
        for (int i = 0; i < 12; ++i)
          check.target[i][lane] = pose_value(T, i);
        for (Eigen::Index j = 0; j < q.size(); ++j)
          check.q[j][lane] = q[j];
      }
      set.kernels.check(arm, check);
      for (int lane = 0; lane < kLanes; ++lane) {
        EXPECT_NEAR(check.distance_m[lane], expected(0, lane), 1e-12 * (1 + expected(0, lane)));
        EXPECT_NEAR(check.angle_rad[lane], expected(1, lane), 1e-6) << set.name;
      }
    }
}

/// Eight lanes that start near the configurations of their poses.
struct Descents {
  explicit Descents(const kinematics::Chain& of, double off, std::mt19937_64& generator)
      : chain(of), lanes(lane_chain(of)) {
    std::uniform_real_distribution<double> uniform(-off, off);
    for (int lane = 0; lane < kLanes; ++lane) {
      const Eigen::VectorXd q = test::random_configuration(chain, generator);
      const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
      for (int i = 0; i < 12; ++i)
        batch.target[i][lane] = pose_value(T, i) / (i < 9 ? 1 : lanes.length_m);
      for (int j = 0; j < lanes.dof; ++j) {
        const LaneJoint& joint = lanes.joints[j];
        const double room = joint.slides ? joint.half : 1;
        batch.q[j][lane] = q[j] * joint.scale + joint.offset + uniform(generator) * room;
      }
    }
  }

  const kinematics::Chain& chain;
  LaneChain lanes;
  LaneBatch batch;
};

TEST(Lanes, DescentsFromNearbyReachTheirPoses) {
  std::mt19937_64 generator(kSeed);
  int reached = 0, all = 0;
  for (const kinematics::Chain& chain : many_chains())
    for (const InstructionSet& set : instruction_sets()) {
      Descents descents(chain, 0.05, generator);
      for (int i = 0; i < 20; ++i)
        set.kernels.step(descents.lanes, LaneLimits::Ignore, descents.batch);
      for (const double squared : descents.batch.squared)
        reached += squared < 1e-16 ? 1 : 0;
      all += kLanes;
    }
  EXPECT_GE(reached, 0.97 * all);
}

TEST(Lanes, EveryInstructionSetMakesTheSameStep) {
  std::mt19937_64 generator(kSeed);
  for (const kinematics::Chain& chain : many_chains())
    for (const LaneLimits limits : {LaneLimits::Steer, LaneLimits::Ignore, LaneLimits::Hold}) {
      const Descents descents(chain, 2, generator);
      LaneBatch first = descents.batch;
      instruction_sets().front().kernels.step(descents.lanes, limits, first);
      for (const InstructionSet& set : instruction_sets()) {
        LaneBatch batch = descents.batch;
        set.kernels.step(descents.lanes, limits, batch);
        for (int lane = 0; lane < kLanes; ++lane) {
          EXPECT_NEAR(batch.squared[lane], first.squared[lane], 1e-9 * (1 + first.squared[lane]));
          EXPECT_EQ(batch.outside[lane], first.outside[lane]);
          for (int j = 0; j < descents.lanes.dof; ++j)
            EXPECT_NEAR(batch.q[j][lane], first.q[j][lane], 1e-6) << set.name;
        }
      }
    }
}

TEST(Lanes, HeldJointsStayWithinTheirLimits) {
  std::mt19937_64 generator(kSeed);
  const kinematics::Chain chain =
      test::random_chain({.joints = 7, .limit = 1, .sliding_share = 0.3}, generator);
  Descents descents(chain, 0, generator);
  Descents others(chain, 0, generator);
  std::copy(&others.batch.target[0][0], &others.batch.target[0][0] + 12 * kLanes,
            &descents.batch.target[0][0]);
  for (int i = 0; i < 20; ++i) {
    instruction_sets().back().kernels.step(descents.lanes, LaneLimits::Hold, descents.batch);
    for (int j = 0; j < 7; ++j)
      for (const double value : descents.batch.q[j])
        ASSERT_LE(std::abs(value - descents.lanes.joints[j].middle),
                  descents.lanes.joints[j].half + 1e-12);
  }
}

/// A planar joint against a pose that is half a turn away, where the axis of the rotation error
/// cannot be told.
TEST(Lanes, HalfATurnIsLeftAndIsNoSolution) {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "tip";
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0)})
    parts.joints.push_back({.name = "joint", .axis = axis, .lower = -4, .upper = 4});
  const kinematics::Chain chain(parts);
  const LaneChain lanes = lane_chain(chain);
  LaneBatch batch;
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int i = 0; i < 12; ++i)
      batch.target[i][lane] = i == 0 || i == 4 ? -1 : i == 8 ? 1 : 0;
    for (int j = 0; j < 3; ++j)
      batch.q[j][lane] = lanes.joints[j].offset;
  }
  instruction_sets().back().kernels.step(lanes, LaneLimits::Ignore, batch);
  EXPECT_GT(batch.squared[0], 1);
  for (int i = 0; i < 40; ++i)
    instruction_sets().back().kernels.step(lanes, LaneLimits::Ignore, batch);
  EXPECT_LT(batch.squared[0], 1e-16);
}

bool is_same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).unaryExpr([](double turn) { return std::remainder(turn, 2 * M_PI); }).norm() <
         1e-7;
}

struct Compared {
  int branches = 0, hard = 0;
};

/// Each branch of eight values of the locked joints, side by side, is one that the values alone
/// give, and none is missing but of lanes left to that.
void compare_with_alone(const ClosedForm& form, const InstructionSet& set,
                        const Eigen::Isometry3d& T, const double (&locked)[kLaneLocks][kLanes],
                        Eigen::Index dof, Compared& compared) {
  LaneWristBranches together;
  form.append_lanes(set.kernels, T, locked, LaneWristBranches::kCapacity, together);
  compared.hard += std::popcount(together.hard);
  std::vector<Eigen::VectorXd> left;
  for (int i = 0; i < together.count; ++i)
    form.write(together, i, locked, left.emplace_back(dof).data());
  for (int lane = 0; lane < kLanes; ++lane) {
    if ((together.hard >> static_cast<unsigned>(lane) & 1U) != 0)
      continue;
    const std::array<double, kLaneLocks> values = {locked[0][lane], locked[1][lane]};
    Branches alone;
    form.append(T, {values.data(), form.locks().size()}, alone);
    for (int i = 0; i < alone.size(); ++i, ++compared.branches) {
      const Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(alone[i], dof);
      const auto same = std::ranges::find_if(
          left, [&](const Eigen::VectorXd& other) { return is_same(q, other); });
      ASSERT_NE(same, left.end()) << set.name;
      left.erase(same);
    }
  }
  ASSERT_TRUE(left.empty()) << set.name;
}

TEST(Lanes, WristsGiveTheBranchesOfEachLockedValue) {
  for (const char* name : {"iiwa14", "panda", "sara_like"}) {
    const kinematics::Chain chain = test::model_chain(name);
    const ClosedFormFinding finding = find_closed_form(chain);
    ASSERT_TRUE(finding.form && finding.form->has_lanes()) << name;
    std::mt19937_64 generator(5);
    Compared compared;
    for (int pose = 0; pose < 100; ++pose) {
      const Eigen::Isometry3d T =
          kinematics::T_base_transfer(chain, test::random_configuration(chain, generator));
      double locked[kLaneLocks][kLanes] = {};
      for (int lane = 0; lane < kLanes; ++lane) {
        const Eigen::VectorXd q = test::random_configuration(chain, generator);
        for (std::size_t k = 0; k < finding.form->locks().size(); ++k)
          locked[k][lane] = q[finding.form->locks()[k]];
      }
      for (const InstructionSet& set : instruction_sets())
        ASSERT_NO_FATAL_FAILURE(
            compare_with_alone(*finding.form, set, T, locked, chain.dof(), compared))
            << name << ", pose " << pose;
    }
    EXPECT_GT(compared.branches, 1000) << name;
    EXPECT_LT(compared.hard, compared.branches / 10) << name;
  }
}

TEST(LaneChain, ReachBoundsTheArm) {
  EXPECT_NEAR(reach_m(test::PlanarArm{.lengths_m = {0.5, 0.4, 0.2}}.chain()), 1.1, 1e-12);
}

}  // namespace
}  // namespace kinship::inverse::lanes_test
