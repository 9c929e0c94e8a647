#include "robots/kinematics/forward_kinematics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "robots/kinematics/joint_motion.hpp"
#include "tests/support/random_chain.hpp"
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

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

Eigen::Matrix3d joined(const AxisTurns& turns) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  return about(z, turns.before) * about(x, std::atan2(turns.tilt_sine, turns.tilt_cosine)) *
         about(z, turns.after);
}

TEST(AxisTurns, MakeTheRotation) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3d R = test::random_pose(1, generator).linear();
    EXPECT_LT((joined(axis_turns(R)) - R).norm(), 1e-14) << R;
  }
}

TEST(AxisTurns, MakeItAlsoWhereTheAxesAreNearlyParallel) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  for (const double over : {0.0, M_PI})
    for (const double tilt : {0.0, 1e-15, 1e-13, 1e-10, 1e-7, -1e-11})
      for (const double turn : {0.0, 0.7, -2.5, M_PI}) {
        const Eigen::Matrix3d R = about(z, 0.4) * about(x, over + tilt) * about(z, turn);
        EXPECT_LT((joined(axis_turns(R)) - R).norm(), 2e-12) << over << " " << tilt << " " << turn;
      }
}

}  // namespace
}  // namespace kinship::kinematics::forward_kinematics_test

namespace kinship::kinematics::jacobian_test {
namespace {

constexpr std::uint64_t kSeed = 9;

/// Central differences of forward kinematics.
Jacobian difference_quotient(const Chain& chain, const Eigen::VectorXd& q) {
  constexpr double kStep = 1e-6;
  Jacobian J(6, chain.dof());
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(chain.dof(), i);
    const Eigen::Isometry3d before = T_base_tip(chain, q - step);
    const Eigen::Isometry3d after = T_base_tip(chain, q + step);
    const Eigen::AngleAxisd turn(after.linear() * before.linear().transpose());
    J.col(i).head<3>() = (after.translation() - before.translation()) / (2 * kStep);
    J.col(i).tail<3>() = turn.angle() * turn.axis() / (2 * kStep);
  }
  return J;
}

TEST(Jacobian, AgreesWithDifferenceQuotients) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 200; ++i) {
    const Chain chain(random_parts(1 + i % 9, generator));
    const Eigen::VectorXd q = random_configuration(chain, generator);
    const Jacobian error = J_base_tip(chain, q) - difference_quotient(chain, q);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-7) << "chain " << i;
  }
}

TEST(Jacobian, RefusesAConfigurationOfAnotherSize) {
  std::mt19937_64 generator(kSeed);
  const Chain chain(random_parts(3, generator));
  EXPECT_THROW(J_base_tip(chain, Eigen::VectorXd::Zero(2)), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::kinematics::jacobian_test
