#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/robots.hpp"

namespace kinship::models_test {
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

/// Spherical shoulder, elbow, spherical wrist: base to shoulder, upper arm, forearm, wrist to
/// flange.
Eigen::Isometry3d anthropomorphic_dh(const std::array<double, 4>& lengths_m,
                                     const Eigen::VectorXd& q) {
  return standard_dh({{lengths_m[0], 0, -kPi / 2},
                      {0, 0, kPi / 2},
                      {lengths_m[1], 0, kPi / 2},
                      {0, 0, -kPi / 2},
                      {lengths_m[2], 0, -kPi / 2},
                      {0, 0, kPi / 2},
                      {lengths_m[3], 0, 0}},
                     q);
}

Eigen::Isometry3d iiwa14_dh(const Eigen::VectorXd& q) {
  return anthropomorphic_dh({0.36, 0.42, 0.40, 0.126}, q);
}

Eigen::Isometry3d iiwa7_dh(const Eigen::VectorXd& q) {
  return anthropomorphic_dh({0.34, 0.40, 0.40, 0.126}, q);
}

Eigen::Isometry3d sara_like_dh(const Eigen::VectorXd& q) {
  return anthropomorphic_dh({0.36, 0.55, 0.50, 0.20}, q);
}

/// From axis to axis of the straight arm, which points along x. Source: rpiRobotics/stereo-sew,
/// sawyer.m.
Eigen::Isometry3d sawyer_by_axes(const Eigen::VectorXd& q) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  Eigen::Isometry3d hand = Eigen::Isometry3d::Identity();
  hand.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return shift(0, 0, 0.317) * rotation(q[0], Eigen::Vector3d::UnitZ()) * shift(0.081, 0, 0) *
         rotation(q[1], y) * shift(0, 0.1925, 0) * rotation(q[2], x) * shift(0.4, 0, 0) *
         rotation(q[3], y) * shift(0, -0.1685, 0) * rotation(q[4], x) * shift(0.4, 0, 0) *
         rotation(q[5], y) * shift(0, 0.1363, 0) * rotation(q[6], x) * shift(0.1345, 0, 0) *
         rotation(-0.17453, x) * hand;
}

Eigen::Isometry3d sum_of_links(const std::vector<double>& lengths_m, const Eigen::VectorXd& q) {
  double x = 0, y = 0, angle = 0;
  for (std::size_t i = 0; i < lengths_m.size(); ++i) {
    angle += q[static_cast<Eigen::Index>(i)];
    x += lengths_m[i] * std::cos(angle);
    y += lengths_m[i] * std::sin(angle);
  }
  return shift(x, y, 0) * rotation(angle, Eigen::Vector3d::UnitZ());
}

Eigen::Isometry3d planar_5r_a(const Eigen::VectorXd& q) {
  return sum_of_links({0.25, 0.25, 0.20, 0.15, 0.15}, q);
}

Eigen::Isometry3d planar_5r_b(const Eigen::VectorXd& q) {
  return sum_of_links({0.15, 0.30, 0.25, 0.15, 0.15}, q);
}

Eigen::Isometry3d planar_7r_c(const Eigen::VectorXd& q) {
  return sum_of_links({0.18, 0.17, 0.16, 0.15, 0.13, 0.11, 0.10}, q);
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

/// On a lift whose first joint goes up from 0.3 m.
template <Eigen::Isometry3d (*arm)(const Eigen::VectorXd&)>
Eigen::Isometry3d on_lift(const Eigen::VectorXd& q) {
  return shift(0, 0, 0.3 + q[0]) * arm(q.tail(q.size() - 1));
}

struct Model {
  std::string name;
  Eigen::Isometry3d (*expected)(const Eigen::VectorXd&);  ///< pose of the tip, from another source
  double tolerance;  ///< the URDFs of UR10e and Sawyer round their angles
};

const std::vector<Model> kSamplingModes = {{"panda", panda_dh, 1e-12},
                                           {"iiwa14", iiwa14_dh, 1e-12},
                                           {"iiwa7", iiwa7_dh, 1e-12},
                                           {"ur10e", ur10e_dh, 3e-9},
                                           {"sawyer", sawyer_by_axes, 2e-5},
                                           {"sara_like", sara_like_dh, 1e-12},
                                           {"panda_lift", on_lift<panda_dh>, 1e-12},
                                           {"iiwa14_lift", on_lift<iiwa14_dh>, 1e-12}};
const std::vector<Model> kPlanarArms = {{"planar_5r_a", planar_5r_a, 1e-12},
                                        {"planar_5r_b", planar_5r_b, 1e-12},
                                        {"planar_7r_c", planar_7r_c, 1e-12}};

std::string name_of(const testing::TestParamInfo<Model>& model) { return model.param.name; }

class Models : public testing::TestWithParam<Model> {
 protected:
  Chain chain_ = model_chain(GetParam().name);
  std::mt19937_64 generator_{kSeed};
};

TEST_P(Models, ForwardKinematicsAgreesWithTheTableOfTheArm) {
  for (int i = 0; i < 1000; ++i) {
    const Eigen::VectorXd q = random_configuration(chain_, generator_);
    const Eigen::Matrix4d error =
        (T_base_tip(chain_, q).matrix() - GetParam().expected(q).matrix());
    ASSERT_LT(error.cwiseAbs().maxCoeff(), GetParam().tolerance);
  }
}

class ModelsWithGripper : public Models {};

TEST_P(ModelsWithGripper, TransferFrameIsThePalmWhereverTheArmIs) {
  const auto palm = static_cast<std::size_t>(chain_.find_link("palm"));
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd q = random_configuration(chain_, generator_);
    EXPECT_TRUE(T_base_transfer(chain_, q).isApprox(link_poses(chain_, q)[palm], 1e-12));
  }
}

TEST_P(ModelsWithGripper, FlangeLies60MillimetresBehindThePalmAlongItsZAxis) {
  const Eigen::Isometry3d& T_tip_palm = chain_.T_tip_transfer();
  EXPECT_TRUE(T_tip_palm.translation().isApprox(Eigen::Vector3d(0, 0, 0.06)));
  EXPECT_TRUE(T_tip_palm.linear().col(2).isApprox(Eigen::Vector3d::UnitZ()));
}

TEST_P(ModelsWithGripper, FingersStandOpenAlikeOnEveryRobot) {
  const auto poses = link_poses(chain_, Eigen::VectorXd::Zero(chain_.dof()));
  const auto pose_of = [&](const char* link) {
    return poses[static_cast<std::size_t>(chain_.find_link(link))];
  };
  const Eigen::Isometry3d T_palm_left = pose_of("palm").inverse() * pose_of("finger_left");
  const Eigen::Isometry3d T_palm_right = pose_of("palm").inverse() * pose_of("finger_right");
  EXPECT_TRUE(T_palm_left.isApprox(shift(0, 0.0425, 0), 1e-12));
  EXPECT_TRUE(T_palm_right.isApprox(shift(0, -0.0425, 0), 1e-12));
}

INSTANTIATE_TEST_SUITE_P(Arms, Models, testing::ValuesIn(kSamplingModes), name_of);
INSTANTIATE_TEST_SUITE_P(Planar, Models, testing::ValuesIn(kPlanarArms), name_of);
INSTANTIATE_TEST_SUITE_P(All, ModelsWithGripper, testing::ValuesIn(kSamplingModes), name_of);

class PlanarModels : public Models {};

TEST_P(PlanarModels, OnlyPlaceAndDirectionInThePlaneMatter) {
  EXPECT_EQ(chain_.task_axes().matters, (std::array{true, true, false, false, false, true}));
}

TEST_P(PlanarModels, ReachOneMetreWithTheTransferFrameAtTheTip) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(chain_.dof());
  EXPECT_TRUE(T_base_transfer(chain_, zero).isApprox(shift(1, 0, 0), 1e-12));
}

INSTANTIATE_TEST_SUITE_P(All, PlanarModels, testing::ValuesIn(kPlanarArms), name_of);

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

TEST(ReferencePoses, Iiwa7) {
  EXPECT_TRUE(T_base_tip(model_chain("iiwa7"), Eigen::VectorXd::Zero(7))
                  .isApprox(shift(0, 0, 1.266), 1e-12));
}

/// The manufacturer's neutral pose.
TEST(ReferencePoses, Sawyer) {
  Eigen::VectorXd neutral(7);
  neutral << 0, -1.18, 0, 2.18, 0, 0.57, 3.3161;
  const Eigen::Isometry3d T = T_base_tip(model_chain("sawyer"), neutral);
  EXPECT_TRUE(T.translation().isApprox(Eigen::Vector3d(0.4496, 0.1603, 0.2158), 2e-4));
  EXPECT_LT(T.linear()(2, 2), -0.9999);  // the hand points down
}

TEST(ReferencePoses, SaraLikeReaches1250MillimetresFromItsShoulder) {
  EXPECT_TRUE(T_base_tip(model_chain("sara_like"), Eigen::VectorXd::Zero(7))
                  .isApprox(shift(0, 0, 0.36 + 1.25), 1e-12));
}

TEST(ReferencePoses, Ur10e) {
  Eigen::Isometry3d expected = shift(1.18425, 0.2907, 0.06085);
  expected.linear() << -1, 0, 0, 0, 0, 1, 0, 1, 0;
  EXPECT_TRUE(T_base_tip(model_chain("ur10e"), Eigen::VectorXd::Zero(6)).isApprox(expected, 1e-8));
}

TEST(ReferenceLimits, AreThoseOfTheManufacturers) {
  EXPECT_EQ(model_chain("panda").upper()[3], -0.0698);
  EXPECT_NEAR(model_chain("iiwa14").lower()[6], -175 * kPi / 180, 1e-12);
  EXPECT_NEAR(model_chain("iiwa7").upper()[1], 120 * kPi / 180, 1e-12);
  EXPECT_EQ(model_chain("sawyer").lower()[1], -3.8095);
  EXPECT_NEAR(model_chain("ur10e").upper()[2], kPi, 1e-12);
  EXPECT_NEAR(model_chain("ur10e").upper()[0], 2 * kPi, 1e-12);
}

}  // namespace
}  // namespace kinship::models_test
