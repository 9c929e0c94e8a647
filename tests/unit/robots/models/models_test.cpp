#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/jacobian.hpp"
#include "tests/support/robots.hpp"

namespace kinship {
namespace {

using kinematics::Chain;
using test::model_chain;
using test::random_configuration;

constexpr std::uint64_t kSeed = 11;
constexpr double kPi = std::numbers::pi;

/// One row of a Denavit-Hartenberg table, in the order of the manufacturers' tables.
struct DhRow {
  double d, a, alpha;
};

Eigen::Isometry3d rotation(double angle, const Eigen::Vector3d& axis) {
  return Eigen::Isometry3d(Eigen::AngleAxisd(angle, axis));
}

Eigen::Isometry3d shift(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

/// Standard convention: Rz(q) Tz(d) Tx(a) Rx(alpha). Source: Siciliano et al. (2009), eq. 2.52.
Eigen::Isometry3d standard_dh(const std::vector<DhRow>& table, const Eigen::VectorXd& q) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < table.size(); ++i)
    T = T * rotation(q[static_cast<Eigen::Index>(i)], Eigen::Vector3d::UnitZ()) *
        shift(table[i].a, 0, table[i].d) * rotation(table[i].alpha, Eigen::Vector3d::UnitX());
  return T;
}

/// Modified convention: Rx(alpha) Tx(a) Rz(q) Tz(d). Source: Craig, Introduction to Robotics.
Eigen::Isometry3d modified_dh(const std::vector<DhRow>& table, const Eigen::VectorXd& q) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < table.size(); ++i)
    T = T * rotation(table[i].alpha, Eigen::Vector3d::UnitX()) * shift(table[i].a, 0, 0) *
        rotation(q[static_cast<Eigen::Index>(i)], Eigen::Vector3d::UnitZ()) *
        shift(0, 0, table[i].d);
  return T;
}

Eigen::Isometry3d panda_dh(const Eigen::VectorXd& q) {
  return modified_dh({{0.333, 0, 0},
                      {0, 0, -kPi / 2},
                      {0.316, 0, kPi / 2},
                      {0, 0.0825, kPi / 2},
                      {0.384, -0.0825, -kPi / 2},
                      {0, 0, kPi / 2},
                      {0, 0.088, kPi / 2}},
                     q) *
         shift(0, 0, 0.107);
}

Eigen::Isometry3d iiwa14_dh(const Eigen::VectorXd& q) {
  return standard_dh({{0.36, 0, -kPi / 2},
                      {0, 0, kPi / 2},
                      {0.42, 0, kPi / 2},
                      {0, 0, -kPi / 2},
                      {0.40, 0, -kPi / 2},
                      {0, 0, kPi / 2},
                      {0.126, 0, 0}},
                     q);
}

Eigen::Isometry3d ur10e_dh(const Eigen::VectorXd& q) {
  return rotation(kPi, Eigen::Vector3d::UnitZ()) * standard_dh({{0.1807, 0, kPi / 2},
                                                                {0, -0.6127, 0},
                                                                {0, -0.57155, 0},
                                                                {0.17415, 0, kPi / 2},
                                                                {0.11985, 0, -kPi / 2},
                                                                {0.11655, 0, 0}},
                                                               q);
}

struct Model {
  std::string name;
  Eigen::Isometry3d (*dh)(const Eigen::VectorXd&);
  double tolerance;  ///< the UR10e's URDF rounds its angles
};

class Models : public testing::TestWithParam<Model> {
 protected:
  Chain chain_ = model_chain(GetParam().name);
  std::mt19937_64 generator_{kSeed};
};

TEST_P(Models, ForwardKinematicsAgreesWithTheDhTable) {
  for (int i = 0; i < 1000; ++i) {
    const Eigen::VectorXd q = random_configuration(chain_, generator_);
    const Eigen::Matrix4d error = (T_base_tip(chain_, q).matrix() - GetParam().dh(q).matrix());
    ASSERT_LT(error.cwiseAbs().maxCoeff(), GetParam().tolerance);
  }
}

TEST_P(Models, JacobianAgreesWithDifferenceQuotients) {
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd q = random_configuration(chain_, generator_);
    const kinematics::Jacobian J = J_base_tip(chain_, q);
    for (Eigen::Index k = 0; k < chain_.dof(); ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(chain_.dof(), k);
      const Eigen::Isometry3d after = T_base_tip(chain_, q + step);
      const Eigen::Isometry3d before = T_base_tip(chain_, q - step);
      const Eigen::AngleAxisd turn(after.linear() * before.linear().transpose());
      Eigen::Matrix<double, 6, 1> expected;
      expected << after.translation() - before.translation(), turn.angle() * turn.axis();
      EXPECT_TRUE(J.col(k).isApprox(expected / (2 * kStep), 1e-7));
    }
  }
}

TEST_P(Models, TransferFrameIsThePalmWhereverTheArmIs) {
  const auto palm = static_cast<std::size_t>(chain_.find_link("palm"));
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd q = random_configuration(chain_, generator_);
    EXPECT_TRUE(T_base_transfer(chain_, q).isApprox(link_poses(chain_, q)[palm], 1e-12));
  }
}

TEST_P(Models, FlangeLies60MillimetresBehindThePalmAlongItsZAxis) {
  const Eigen::Isometry3d& T_tip_palm = chain_.T_tip_transfer();
  EXPECT_TRUE(T_tip_palm.translation().isApprox(Eigen::Vector3d(0, 0, 0.06)));
  EXPECT_TRUE(T_tip_palm.linear().col(2).isApprox(Eigen::Vector3d::UnitZ()));
}

TEST_P(Models, FingersStandOpenAlikeOnEveryRobot) {
  const auto poses = link_poses(chain_, Eigen::VectorXd::Zero(chain_.dof()));
  const auto pose_of = [&](const char* link) {
    return poses[static_cast<std::size_t>(chain_.find_link(link))];
  };
  const Eigen::Isometry3d T_palm_left = pose_of("palm").inverse() * pose_of("finger_left");
  const Eigen::Isometry3d T_palm_right = pose_of("palm").inverse() * pose_of("finger_right");
  EXPECT_TRUE(T_palm_left.isApprox(shift(0, 0.0425, 0), 1e-12));
  EXPECT_TRUE(T_palm_right.isApprox(shift(0, -0.0425, 0), 1e-12));
}

INSTANTIATE_TEST_SUITE_P(All, Models,
                         testing::Values(Model{"panda", panda_dh, 1e-12},
                                         Model{"iiwa14", iiwa14_dh, 1e-12},
                                         Model{"ur10e", ur10e_dh, 3e-9}),
                         [](const auto& model) { return model.param.name; });

TEST(ReferencePoses, Panda) {
  const Chain chain = model_chain("panda");
  EXPECT_TRUE(T_base_tip(chain, Eigen::VectorXd::Zero(7))
                  .translation()
                  .isApprox(Eigen::Vector3d(0.088, 0, 0.926), 1e-12));
  Eigen::VectorXd ready(7);
  ready << 0, -kPi / 4, 0, -3 * kPi / 4, 0, kPi / 2, kPi / 4;
  EXPECT_TRUE(T_base_tip(chain, ready)
                  .translation()
                  .isApprox(Eigen::Vector3d(0.306891, 0, 0.590282), 1e-6));
  const Eigen::Isometry3d T_base_palm = T_base_transfer(chain, ready);
  EXPECT_TRUE(T_base_palm.linear().col(2).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9));
}

TEST(ReferencePoses, Iiwa14) {
  EXPECT_TRUE(T_base_tip(model_chain("iiwa14"), Eigen::VectorXd::Zero(7))
                  .isApprox(shift(0, 0, 1.306), 1e-12));
}

TEST(ReferencePoses, Ur10e) {
  Eigen::Isometry3d expected = shift(1.18425, 0.2907, 0.06085);
  expected.linear() << -1, 0, 0, 0, 0, 1, 0, 1, 0;
  EXPECT_TRUE(T_base_tip(model_chain("ur10e"), Eigen::VectorXd::Zero(6)).isApprox(expected, 1e-8));
}

TEST(ReferenceLimits, AreThoseOfTheManufacturers) {
  EXPECT_EQ(model_chain("panda").upper()[3], -0.0698);
  EXPECT_NEAR(model_chain("iiwa14").lower()[6], -175 * kPi / 180, 1e-12);
  EXPECT_NEAR(model_chain("ur10e").upper()[2], kPi, 1e-12);
  EXPECT_NEAR(model_chain("ur10e").upper()[0], 2 * kPi, 1e-12);
}

}  // namespace
}  // namespace kinship
