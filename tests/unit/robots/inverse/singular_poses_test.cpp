#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "robots/inverse/closed_form.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"
#include "tests/unit/robots/inverse/checked_inverse.hpp"

namespace kinship::inverse::singular_poses_test {
namespace {

using kinematics::Chain;
using kinematics::T_base_tip;
constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kSeed = 31;

/// The same configuration with the wrist of joints 4, 5, 6 turned over.
Eigen::VectorXd turned_over(Eigen::VectorXd q) {
  q[3] += kPi;
  q[4] = -q[4];
  q[5] += kPi;
  return q;
}

/// The elbows fall together, and the shoulder cannot reach as far from its other side.
TEST(SingularPoses, AStraightArmHasOneElbow) {
  const Chain chain = test::arms::industrial();
  const Solver solver(chain);
  for (const double lean : {0.1, 0.5, 1.3}) {
    Eigen::VectorXd q(6);
    q << 0.3, lean, IndustrialArm::straight(), 1.1, -0.8, 0.2;
    const auto found = checked(chain, solver, T_base_tip(chain, q));
    EXPECT_EQ(found.configurations.cols(), 2) << found.configurations;
    EXPECT_TRUE(holds(chain, found, q));
    EXPECT_TRUE(holds(chain, found, turned_over(q)));
  }
}

/// The wrist, 0.46 m below joint 2, has both elbows from the shoulder's other side.
TEST(SingularPoses, AFoldedArmHasOneElbowOnItsSide) {
  const Chain chain = test::arms::industrial();
  Eigen::VectorXd q(6);
  q << 0.3, 0.5, IndustrialArm::folded(), 1.1, -0.8, 0.2;
  const auto found = checked(chain, Solver(chain), T_base_tip(chain, q));
  EXPECT_EQ(found.configurations.cols(), 6) << found.configurations;
  EXPECT_TRUE(holds(chain, found, q));
  EXPECT_TRUE(holds(chain, found, turned_over(q)));
}

/// The wrist stands above joint 1, which may then have any value: `q1` is one of them.
Eigen::VectorXd upright(double q1) {
  constexpr double kElbow = 0.7;
  const double x =
      IndustrialArm::kFore_x_m * std::cos(kElbow) + IndustrialArm::kFore_z_m * std::sin(kElbow);
  const double z = IndustrialArm::kUpper_m - IndustrialArm::kFore_x_m * std::sin(kElbow) +
                   IndustrialArm::kFore_z_m * std::cos(kElbow);
  Eigen::VectorXd q(6);
  q << q1, std::asin(-IndustrialArm::kShoulder_m / std::hypot(x, z)) - std::atan2(x, z), kElbow,
      0.4, -0.8, 0.2;
  return q;
}

TEST(SingularPoses, AnUprightArmStandsForItsFamily) {
  const Chain chain = test::arms::industrial();
  const Solver solver(chain);
  for (const double q1 : {0.0, 0.9, -2.0}) {
    const Eigen::VectorXd q = upright(q1);
    const auto found = checked(chain, solver, T_base_tip(chain, q));
    bool represented = false;
    for (const auto& solution : found.configurations.colwise())
      represented = represented || (solution - q).segment<2>(1).norm() < 1e-5;
    EXPECT_TRUE(represented) << found.configurations;
  }
}

/// A place for every joint that is not 0, which is what closed forms take for a free joint.
Chain around(const Chain& chain, const Eigen::VectorXd& q) {
  return with_limits(chain, (q.array() - 0.2).matrix(), (q.array() + 0.15).matrix());
}

TEST(SingularPoses, AnUprightArmIsFoundWhereItsLimitsAllowIt) {
  for (const double q1 : {0.9, -2.0}) {
    const Eigen::VectorXd q = upright(q1);
    const Chain chain = around(test::arms::industrial(), q);
    EXPECT_GT(checked(chain, Solver(chain), T_base_tip(chain, q)).configurations.cols(), 0) << q1;
  }
}

TEST(SingularPoses, AStraightWristTurnsWithTwoJointsAsOne) {
  for (const Chain& chain : {test::arms::industrial(), test::arms::hollow_wrist()}) {
    Eigen::VectorXd q(6);
    q << 0.3, 0.5, 0.4, 1.1, 0, 0.2;
    const auto found = checked(chain, Solver(chain), T_base_tip(chain, q));
    bool represented = false;
    for (const auto& solution : found.configurations.colwise())
      represented = represented ||
                    ((solution - q).head<3>().norm() < 1e-5 && std::abs(solution[4]) < 1e-5 &&
                     std::abs(std::remainder(solution[3] + solution[5] - 1.3, 2 * kPi)) < 1e-5);
    EXPECT_TRUE(represented) << found.configurations;
  }
}

/// An arm and the joint whose value 0 aligns the axes on both its sides.
struct Aligned {
  std::string name;
  std::function<Chain()> chain;
  Eigen::Index joint;
};

class AlignedAxes : public testing::TestWithParam<Aligned> {};

/// The one of a family that the limits allow is not the one that a closed form takes for all.
TEST_P(AlignedAxes, AreSolvedWhereLimitsAllowIt) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> value(0.4, 1.4);
  const Chain free = GetParam().chain();
  for (int i = 0; i < 8; ++i) {
    Eigen::VectorXd q(free.dof());
    for (double& joint : q)
      joint = (generator() % 2 == 0 ? 1 : -1) * value(generator);
    q[GetParam().joint] = 0;
    const Chain chain = around(free, q);
    const auto found = checked(chain, Solver(chain), T_base_tip(chain, q), {});
    EXPECT_GT(found.configurations.cols(), 0) << q.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Arms, AlignedAxes,
    testing::Values(Aligned{"wrist", test::arms::industrial, 4},
                    Aligned{"hollow_wrist", test::arms::hollow_wrist, 4},
                    Aligned{"shoulder", test::arms::spherical_shoulder, 1},
                    Aligned{"ur10e", [] { return test::model_chain("ur10e"); }, 4},
                    Aligned{"iiwa14_shoulder", [] { return test::model_chain("iiwa14"); }, 1},
                    Aligned{"iiwa14_elbow", [] { return test::model_chain("iiwa14"); }, 3},
                    Aligned{"iiwa14_wrist", [] { return test::model_chain("iiwa14"); }, 5},
                    Aligned{"panda_shoulder", [] { return test::model_chain("panda"); }, 1},
                    Aligned{"sawyer_wrist", [] { return test::model_chain("sawyer"); }, 5}),
    [](const auto& instance) { return instance.param.name; });

/// Arms by the model folder, in poses that people give names to: all joints at 0, and every joint
/// a quarter of a turn from there by itself.
TEST(SingularPoses, EveryModelIsSolvedAtZeroAndAQuarterTurnFromIt) {
  for (const std::string name :
       {"panda", "iiwa14", "iiwa7", "ur10e", "sawyer", "sara_like", "planar_5r_a", "planar_7r_c"}) {
    const Chain chain = test::model_chain(name);
    const Solver solver(chain);
    for (Eigen::Index joint = -1; joint < chain.dof(); ++joint)
      for (const double angle : {-0.5 * kPi, 0.5 * kPi}) {
        Eigen::VectorXd q = Eigen::VectorXd::Zero(chain.dof());
        if (joint >= 0)
          q[joint] = angle;
        q = q.cwiseMax(chain.lower()).cwiseMin(chain.upper());
        EXPECT_GT(checked(chain, solver, T_base_tip(chain, q), {}).configurations.cols(), 0)
            << name << " at " << q.transpose();
      }
  }
}

}  // namespace
}  // namespace kinship::inverse::singular_poses_test
