#include "robots/inverse/solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"

namespace kinship::inverse::wrist_reach_test {
namespace {

constexpr std::uint64_t kSeed = 23;

/// What an arm reaches, it is said to reach: also stretched, and with joints anywhere.
TEST(WristReach, NoPoseOfTheArmIsBeyondIt) {
  std::mt19937_64 generator(kSeed);
  std::vector<kinematics::Chain> chains;
  for (const char* model : {"panda", "iiwa14", "ur10e", "sawyer", "sara_like"})
    chains.push_back(test::model_chain(model));
  for (int i = 0; i < 4; ++i)
    chains.push_back(test::perturbed(chains[static_cast<std::size_t>(i)], 0.05, generator));
  for (const kinematics::Chain& chain : chains) {
    const WristReach reach = WristReach::of(chain).value();
    for (int i = 0; i < 20'000; ++i) {
      Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(chain.dof(), [&] {
        return std::uniform_real_distribution<double>(-M_PI, M_PI)(generator);
      });
      if (i % 2 == 0)
        for (double& value : q)
          value *= generator() % 3 == 0 ? 1e-3 : 1;
      ASSERT_FALSE(reach.is_beyond(kinematics::T_base_transfer(chain, q)));
    }
  }
}

/// With the wrist where three axes meet, the bound is the length of the two links before it.
TEST(WristReach, IsTheLengthOfUpperArmAndForearm) {
  EXPECT_NEAR(WristReach::of(test::model_chain("iiwa14")).value().reach_m(), 0.42 + 0.4, 1e-4);
}

TEST(WristReach, APoseBeyondItIsOutOfReachAtOnce) {
  const kinematics::Chain chain = test::model_chain("iiwa14");
  const Solver solver(chain);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(0.9, 0, 0.36);  // upwards from there: the wrist is below it
  EXPECT_TRUE(WristReach::of(chain).value().is_beyond(T));
  EXPECT_TRUE(solver.beyond_reach(T));
  const InverseSolutions none = solver.solve(T * chain.T_tip_transfer().inverse(), {});
  EXPECT_EQ(none.configurations.cols(), 0);
  EXPECT_EQ(none.reason, NoSolution::OutOfReach);
}

TEST(WristReach, IsNotSaidWhereAPoseDoesNotPlaceTheLastAxis) {
  const test::PlanarArm planar{.lengths_m = {0.3, 0.3, 0.2}, .limit = 2.8};
  EXPECT_FALSE(WristReach::of(planar.chain()));
}

}  // namespace
}  // namespace kinship::inverse::wrist_reach_test
