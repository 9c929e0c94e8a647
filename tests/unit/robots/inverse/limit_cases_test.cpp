#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "robots/inverse/closed_form.hpp"
#include "robots/inverse/joint_space.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"
#include "tests/unit/robots/inverse/checked_inverse.hpp"

namespace kinship::inverse::limit_cases_test {
namespace {

using kinematics::Chain;
using kinematics::JointType;
using kinematics::T_base_tip;
using test::distance;
constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kSeed = 37;

/// The same arm with continuous joints.
Chain continuous(const Chain& chain) {
  kinematics::ChainParts parts = test::parts_of(chain);
  for (kinematics::Joint& joint : parts.joints)
    joint.type = JointType::Continuous;
  return Chain(std::move(parts));
}

/// An arm, and the share of configurations that have to be found again: all by a closed form,
/// nearly all by descents.
struct Subject {
  std::string name;
  std::function<Chain()> chain;
  double share;
};

Chain calibrated() {
  std::mt19937_64 generator(kSeed);
  return test::perturbed(test::arms::industrial(), 1e-3, generator);
}

class LimitsOf : public testing::TestWithParam<Subject> {
 protected:
  Chain free_ = GetParam().chain();
  std::mt19937_64 generator_{kSeed};
};

TEST_P(LimitsOf, AJointExactlyAtItsLimitIsFound) {
  const Chain chain = with_limits(free_, -2, 1.7);
  const Solver solver(chain);
  int recovered = 0, asked = 0;
  for (Eigen::Index joint = 0; joint < 6; ++joint)
    for (const double limit : {-2.0, 1.7})
      for (int i = 0; i < 2; ++i, ++asked) {
        Eigen::VectorXd q = test::random_configuration(chain, generator_);
        q[joint] = limit;
        recovered += holds(chain, checked(chain, solver, T_base_tip(chain, q)), q) ? 1 : 0;
      }
  EXPECT_GE(recovered, GetParam().share * asked);
}

TEST_P(LimitsOf, OneBranchIsAllThatNarrowLimitsLeave) {
  for (int i = 0; i < 6; ++i) {
    const Eigen::VectorXd q = test::random_configuration(free_, generator_);
    const Chain chain = with_limits(free_, (q.array() - 0.1).matrix(), (q.array() + 0.05).matrix());
    const auto found = checked(chain, Solver(chain), T_base_tip(chain, q));
    ASSERT_EQ(found.configurations.cols(), 1) << q.transpose();
    EXPECT_LT((found.configurations.col(0) - q).norm(), 1e-4);
  }
}

TEST_P(LimitsOf, AJointJustBeyondItsLimitIsNot) {
  for (int i = 0; i < 4; ++i) {
    const Eigen::VectorXd q = test::random_configuration(free_, generator_);
    Eigen::VectorXd upper = (q.array() + 0.05).matrix();
    upper[i] = q[i] - 1e-4;
    const Chain chain = with_limits(free_, (q.array() - 0.1).matrix(), upper);
    const auto found = checked(chain, Solver(chain), T_base_tip(chain, q));
    EXPECT_EQ(found.configurations.cols(), 0) << q.transpose();
    EXPECT_EQ(found.reason, NoSolution::Limits);
  }
}

/// However many turns a joint may make, a branch is one solution, the one nearest mid-range.
TEST_P(LimitsOf, MoreThanATurnGivesNoMoreSolutions) {
  const Solver one_turn(free_);
  for (const auto& [lower, upper] : {std::pair{-2 * kPi, 2 * kPi}, {1.0, 1 + 5 * kPi}}) {
    const Chain chain = with_limits(free_, lower, upper);
    const Solver solver(chain);
    int same = 0;
    constexpr int kPoses = 5;
    for (int i = 0; i < kPoses; ++i) {
      const Eigen::VectorXd q = test::random_configuration(chain, generator_);
      const Eigen::Isometry3d T = T_base_tip(chain, q);
      const auto found = checked(chain, solver, T);
      EXPECT_TRUE(holds(chain, found, q)) << q.transpose();
      EXPECT_LE((found.configurations.array() - 0.5 * (lower + upper)).abs().maxCoeff(),
                kPi + 1e-9);
      same += found.configurations.cols() == checked(free_, one_turn, T).configurations.cols();
    }
    EXPECT_GE(same, std::floor(GetParam().share * kPoses));
  }
}

/// Half a turn to either side is the same place, and both values lie within limits of +-pi. One of
/// the six may align its neighbours, and then stands for a family.
TEST_P(LimitsOf, HalfATurnIsFoundOnce) {
  for (const double limit : {kPi, 2 * kPi}) {
    const Chain chain = with_limits(free_, -limit, limit);
    const Solver solver(chain);
    int recovered = 0;
    for (Eigen::Index joint = 0; joint < 6; ++joint) {
      Eigen::VectorXd q = test::random_configuration(chain, generator_);
      q[joint] = joint % 2 == 0 ? kPi : -kPi;
      recovered += holds(chain, checked(chain, solver, T_base_tip(chain, q)), q) ? 1 : 0;
    }
    EXPECT_GE(recovered, 5);
  }
}

TEST_P(LimitsOf, ContinuousJointsAreFoundAcrossTheirSeam) {
  const Chain chain = continuous(free_);
  const Solver solver(chain), with_seam(free_);
  for (const double beside : {0.0, 1e-9, 1e-3}) {
    Eigen::VectorXd q = test::random_configuration(chain, generator_);
    q[0] = kPi - beside;
    q[5] = -kPi + beside;
    const Eigen::Isometry3d T = T_base_tip(chain, q);
    const auto found = checked(chain, solver, T);
    EXPECT_TRUE(holds(chain, found, q)) << q.transpose();
    EXPECT_TRUE((found.configurations.array().abs() <= kPi).all());
    if (GetParam().share == 1) {
      EXPECT_EQ(found.configurations.cols(), checked(free_, with_seam, T).configurations.cols());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, LimitsOf,
                         testing::Values(Subject{"industrial", test::arms::industrial, 1},
                                         Subject{"parallel", test::arms::parallel_forearm, 1},
                                         Subject{"shoulder", test::arms::spherical_shoulder, 1},
                                         Subject{"calibrated", calibrated, 0.9},
                                         Subject{"general", test::arms::general, 0.9}),
                         [](const auto& instance) { return instance.param.name; });

TEST(LimitCases, ASlidingJointCountsAMetreAsARadian) {
  const Chain chain = test::arms::on_track();
  Eigen::VectorXd a = Eigen::VectorXd::Zero(7), b = a;
  b[0] = 0.3;
  b[3] = 0.4;
  EXPECT_NEAR(distance(chain, a, b), 0.5, 1e-12);
  Eigen::VectorXd q(7);
  q << 0.2, 0.3, -0.5, 0.7, 1.1, -0.8, 0.2;
  const Eigen::Isometry3d T = T_base_tip(chain, q);
  const auto found = checked(chain, Solver(chain), T, {.max_solutions = 20, .min_distance = 0.6});
  EXPECT_GT(found.configurations.cols(), 2);
  for (Eigen::Index i = 0; i < found.configurations.cols(); ++i)
    for (Eigen::Index k = 0; k < i; ++k)
      EXPECT_GE((found.configurations.col(i) - found.configurations.col(k)).norm(), 0.6);
}

}  // namespace
}  // namespace kinship::inverse::limit_cases_test
