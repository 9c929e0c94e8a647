#include "robots/kinematics/same_arm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/robots/kinematics/random_chains.hpp"

namespace kinship::kinematics::same_arm_test {
namespace {

constexpr std::uint64_t kSeed = 5;
constexpr int kChains = 36;

/// Every number of the chain moved a little, as a calibration or a rounding does.
ChainParts disturbed(ChainParts parts, double size, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> noise(-size, size);
  for (Joint& joint : parts.joints) {
    joint.T_previous_joint.translation() +=
        Eigen::Vector3d(noise(generator), noise(generator), noise(generator));
    joint.T_previous_joint.rotate(
        Eigen::AngleAxisd(noise(generator), random_vector(generator).normalized()));
    joint.T_previous_joint.linear() =
        Eigen::Quaterniond(joint.T_previous_joint.linear()).normalized().toRotationMatrix();
  }
  return parts;
}

int dof_of(int i) { return 1 + i % 8; }

TEST(SameArm, AChainIsExactlyItself) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < kChains; ++i) {
    const Chain chain(random_parts(dof_of(i), generator));
    EXPECT_EQ(compare_arms(chain, chain), ArmLikeness::Exact);
  }
}

TEST(SameArm, RandomChainsAreDifferent) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < kChains; ++i) {
    const Chain a(random_parts(dof_of(i), generator));
    const Chain b(random_parts(dof_of(i), generator));
    EXPECT_EQ(compare_arms(a, b), ArmLikeness::Different);
  }
}

TEST(SameArm, RoundingIsExact) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < kChains; ++i) {
    const ChainParts parts = random_parts(dof_of(i), generator);
    EXPECT_EQ(compare_arms(Chain(parts), Chain(disturbed(parts, 1e-11, generator))),
              ArmLikeness::Exact);
  }
}

TEST(SameArm, SmallDisturbanceIsNear) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < kChains; ++i) {
    const ChainParts parts = random_parts(dof_of(i), generator);
    EXPECT_EQ(compare_arms(Chain(parts), Chain(disturbed(parts, 1e-5, generator))),
              ArmLikeness::Near);
  }
}

TEST(SameArm, DoesNotDependOnTheOrder) {
  std::mt19937_64 generator(kSeed);
  std::array<int, 3> seen{};
  for (int i = 0; i < kChains; ++i) {
    const ChainParts parts = random_parts(dof_of(i), generator);
    const double size = std::pow(10.0, -1 - i % 12);
    const Chain a(parts), b(disturbed(parts, size, generator));
    const ArmLikeness likeness = compare_arms(a, b);
    EXPECT_EQ(compare_arms(b, a), likeness);
    ++seen.at(static_cast<std::size_t>(likeness));
  }
  EXPECT_GT(*std::min_element(seen.begin(), seen.end()), 5);
}

/// What holds for all configurations must hold for the compared ones, and the other way round as
/// far as a hundred of them can tell.
TEST(SameArm, LikenessHoldsAtOtherConfigurationsToo) {
  std::mt19937_64 generator(kSeed);
  int near = 0;
  for (int i = 0; i < kChains; ++i) {
    const ChainParts parts = random_parts(dof_of(i), generator);
    const Chain a(parts), b(disturbed(parts, 3e-4, generator));
    if (compare_arms(a, b) == ArmLikeness::Different)
      continue;
    ++near;
    for (int k = 0; k < 30; ++k) {
      const Eigen::VectorXd q = random_configuration(a, generator);
      const Eigen::Isometry3d T_a_b = T_base_transfer(a, q).inverse() * T_base_transfer(b, q);
      EXPECT_LT(T_a_b.translation().norm(), 2 * kNearArm_m);
      EXPECT_LT(Eigen::AngleAxisd(T_a_b.linear()).angle(), 2 * kNearArm_rad);
    }
  }
  EXPECT_GT(near, kChains / 4);
}

/// A turning joint and a sliding one.
ChainParts two_joints() {
  ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "tip";
  parts.joints.resize(2);
  parts.joints[0] = {
      "turn", JointType::Revolute, Eigen::Isometry3d::Identity(), Eigen::Vector3d::UnitZ(), -1, 1};
  parts.joints[1] = {
      "slide", JointType::Prismatic, Eigen::Isometry3d::Identity(), Eigen::Vector3d::UnitX(), 0, 1};
  return parts;
}

TEST(SameArm, NamesLimitsTaskAxesAndLinksDoNotCount) {
  ChainParts other = two_joints();
  other.base_link = "other_base";
  other.tip_link = "other_tip";
  other.joints[0].name = "other";
  other.joints[0].lower = -0.3;
  other.joints[1].upper = 7;
  other.task_axes.matters.fill(false);
  other.task_axes.matters[0] = true;
  other.links.push_back({"link", 0, Eigen::Isometry3d::Identity(), -1});
  EXPECT_EQ(compare_arms(Chain(two_joints()), Chain(other)), ArmLikeness::Exact);
}

TEST(SameArm, RevoluteAndContinuousAreOneKindOfMotion) {
  ChainParts other = two_joints();
  other.joints[0].type = JointType::Continuous;
  EXPECT_EQ(compare_arms(Chain(two_joints()), Chain(other)), ArmLikeness::Exact);
}

TEST(SameArm, RevoluteAndPrismaticAreNot) {
  ChainParts other = two_joints();
  other.joints[1].type = JointType::Revolute;
  other.joints[1].upper = 1e-6;  // so short that no pose tells them apart
  ChainParts one = two_joints();
  one.joints[1].upper = 1e-6;
  EXPECT_EQ(compare_arms(Chain(one), Chain(other)), ArmLikeness::Different);
}

TEST(SameArm, WithoutCommonLimitsThereIsNothingToCompare) {
  ChainParts other = two_joints();
  other.joints[1].lower = 1;  // they touch at 1
  other.joints[1].upper = 2;
  EXPECT_EQ(compare_arms(Chain(two_joints()), Chain(other)), ArmLikeness::Different);
}

TEST(SameArm, AJointMoreOrLessIsDifferent) {
  ChainParts other = two_joints();
  other.joints.push_back({"last", JointType::Revolute, Eigen::Isometry3d::Identity(),
                          Eigen::Vector3d::UnitX(), -1, 1});
  EXPECT_EQ(compare_arms(Chain(two_joints()), Chain(other)), ArmLikeness::Different);
  EXPECT_EQ(compare_arms(Chain(other), Chain(two_joints())), ArmLikeness::Different);
}

TEST(SameArm, TolerancesAreThoseOfThePoseOfTheTransferFrame) {
  const Chain chain(two_joints());
  const auto moved = [](double distance_m, double angle_rad) {
    ChainParts parts = two_joints();
    parts.T_tip_transfer.translation().y() = distance_m;
    parts.T_tip_transfer.rotate(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()));
    return Chain(parts);
  };
  EXPECT_EQ(compare_arms(chain, moved(0.99 * kNearArm_m, 0)), ArmLikeness::Near);
  EXPECT_EQ(compare_arms(chain, moved(1.01 * kNearArm_m, 0)), ArmLikeness::Different);
  EXPECT_EQ(compare_arms(chain, moved(0, 0.99 * kNearArm_rad)), ArmLikeness::Near);
  EXPECT_EQ(compare_arms(chain, moved(0, 1.01 * kNearArm_rad)), ArmLikeness::Different);
  EXPECT_EQ(compare_arms(chain, moved(0, std::numbers::pi)), ArmLikeness::Different);
  EXPECT_EQ(compare_arms(chain, moved(0.9 * kExactArm, 0.9 * kExactArm)), ArmLikeness::Exact);
  EXPECT_EQ(compare_arms(chain, moved(1.1 * kExactArm, 0)), ArmLikeness::Near);
  EXPECT_EQ(compare_arms(chain, moved(0, 1.1 * kExactArm)), ArmLikeness::Near);
}

TEST(SameArm, ComparesUpToTheLargestChain) {
  ChainParts parts = two_joints();
  parts.joints.assign(32, parts.joints[0]);
  EXPECT_EQ(compare_arms(Chain(parts), Chain(parts)), ArmLikeness::Exact);
  ChainParts other = parts;
  other.joints.back().axis = -other.joints.back().axis;
  EXPECT_EQ(compare_arms(Chain(parts), Chain(other)), ArmLikeness::Different);
}

}  // namespace
}  // namespace kinship::kinematics::same_arm_test
