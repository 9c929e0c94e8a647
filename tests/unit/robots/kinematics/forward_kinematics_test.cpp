#include "robots/kinematics/forward_kinematics.hpp"

#include <gtest/gtest.h>

#include "tests/unit/robots/kinematics/random_chains.hpp"

namespace kinship::kinematics::forward_kinematics_test {
namespace {

constexpr std::uint64_t kSeed = 8;
constexpr double kTolerance = 1e-12;

/// The same product written with Eigen's own transforms.
Eigen::Isometry3d reference_tip(const Chain& chain, const Eigen::VectorXd& q) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < chain.joints().size(); ++i) {
    const Joint& joint = chain.joints()[i];
    const double value = q[static_cast<Eigen::Index>(i)];
    T = T * joint.T_previous_joint;
    if (joint.type == JointType::Prismatic)
      T.translate(value * joint.axis);
    else
      T.rotate(Eigen::AngleAxisd(value, joint.axis));
  }
  return T * chain.T_last_tip();
}

TEST(ForwardKinematics, AgreesWithTheProductOfTransforms) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 100; ++i) {
    const Chain chain(random_parts(1 + i % 9, generator));
    const Eigen::VectorXd q = random_configuration(chain, generator);
    const Eigen::Isometry3d expected = reference_tip(chain, q);
    EXPECT_TRUE(T_base_tip(chain, q).isApprox(expected, kTolerance));
    EXPECT_TRUE(T_base_transfer(chain, q).isApprox(expected * chain.T_tip_transfer(), kTolerance));
  }
}

TEST(ForwardKinematics, LastJointAndLastLinkLeadToTheTip) {
  std::mt19937_64 generator(kSeed);
  const Chain chain(random_parts(7, generator));
  const Eigen::VectorXd q = random_configuration(chain, generator);
  const auto joints = joint_poses(chain, q);
  const auto links = link_poses(chain, q);
  ASSERT_EQ(joints.size(), 7U);
  ASSERT_EQ(links.size(), 8U);
  EXPECT_TRUE((joints.back() * chain.T_last_tip()).isApprox(T_base_tip(chain, q), kTolerance));
  EXPECT_TRUE(links.back().isApprox(T_base_tip(chain, q), kTolerance));
}

TEST(ForwardKinematics, AJointMovesOnlyTheLinksAfterIt) {
  std::mt19937_64 generator(kSeed);
  const Chain chain(random_parts(6, generator));
  const Eigen::VectorXd q = random_configuration(chain, generator);
  const auto before = link_poses(chain, q);
  for (Eigen::Index moved = 0; moved < 6; ++moved) {
    const auto after = link_poses(chain, q + 0.5 * Eigen::VectorXd::Unit(6, moved));
    for (std::size_t i = 0; i < chain.links().size(); ++i)
      EXPECT_EQ(after[i].isApprox(before[i], kTolerance), chain.links()[i].joint < moved);
  }
}

TEST(ForwardKinematics, RefusesAConfigurationOfAnotherSize) {
  std::mt19937_64 generator(kSeed);
  const Chain chain(random_parts(3, generator));
  EXPECT_THROW(T_base_tip(chain, Eigen::VectorXd::Zero(2)), std::invalid_argument);
  EXPECT_THROW(link_poses(chain, Eigen::VectorXd::Zero(4)), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::kinematics::forward_kinematics_test
