#include "robots/inverse/inverse.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "robots/inverse/joint_space.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/robots.hpp"

namespace kinship::inverse::inverse_test {
namespace {

using test::distance;
using test::normalize;

constexpr std::uint64_t kSeed = 71;
constexpr int kPoses = 400;

class InverseOfModel : public testing::TestWithParam<std::string> {
 protected:
  kinematics::Chain chain_ = test::model_chain(GetParam());
  std::mt19937_64 generator_{kSeed};
};

TEST_P(InverseOfModel, EverySolutionIsRightWithinLimitsAndApart) {
  const InverseOptions options{.max_solutions = 5, .min_distance = 0.5, .seed = kSeed};
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Isometry3d T =
        kinematics::T_base_tip(chain_, test::random_configuration(chain_, generator_));
    const Eigen::MatrixXd solutions = inverse(chain_, T, options).configurations;
    ASSERT_LE(solutions.cols(), 5);
    for (Eigen::Index a = 0; a < solutions.cols(); ++a) {
      const Eigen::Isometry3d difference =
          T.inverse() * kinematics::T_base_tip(chain_, solutions.col(a));
      EXPECT_LT(difference.translation().norm(), 2e-6);
      EXPECT_LT((difference.linear() - Eigen::Matrix3d::Identity()).norm(), 2e-6);
      EXPECT_TRUE(chain_.within_limits(solutions.col(a)));
      for (Eigen::Index b = 0; b < a; ++b)
        EXPECT_GE(distance(chain_, solutions.col(a), solutions.col(b)), 0.5);
    }
  }
}

TEST_P(InverseOfModel, SolvesNearlyEveryReachablePose) {
  int solved = 0;
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Isometry3d T =
        kinematics::T_base_tip(chain_, test::random_configuration(chain_, generator_));
    const auto solutions = inverse(chain_, T, {.max_solutions = 1});
    solved += solutions.configurations.cols() == 1 ? 1 : 0;
  }
  EXPECT_GE(solved, 0.99 * kPoses);
}

INSTANTIATE_TEST_SUITE_P(Models, InverseOfModel,
                         testing::Values("panda", "iiwa14", "iiwa7", "ur10e", "sawyer", "sara_like",
                                         "planar_5r_a", "planar_5r_b", "planar_7r_c", "panda_lift",
                                         "iiwa14_lift"),
                         [](const auto& instance) { return instance.param; });

}  // namespace
}  // namespace kinship::inverse::inverse_test
