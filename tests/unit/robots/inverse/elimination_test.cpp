#include "robots/inverse/elimination.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "proto/types/turn.hpp"
#include "robots/inverse/lane_chain.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/screw_arm.hpp"
#include "tests/unit/robots/inverse/checked_inverse.hpp"

namespace kinship::inverse::elimination_test {
namespace {

constexpr std::uint64_t kSeed = 61;
constexpr int kArms = 4;
constexpr int kPoses = 100;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// The branches of a pose, joint units, any turn.
std::vector<Eigen::VectorXd> branches_of(const LaneChain& lanes, const SimdKernels& kernels,
                                         const LaneElimination& arm, const Eigen::Isometry3d& T) {
  double target[12];
  write_target(T, lanes.length_m, target);
  LaneBranches branches;
  kernels.eliminate(lanes, arm, harmonics(), target, branches);
  std::vector<Eigen::VectorXd> result;
  for (int b = 0; b < branches.count; ++b)
    result.push_back(Eigen::VectorXd::NullaryExpr(
        6, [&](Eigen::Index j) { return branches.q[j][b] - lanes.joints[j].offset; }));
  return result;
}

/// Largest difference of a joint, whole turns aside, between q and the nearest of others.
double nearest(const std::vector<Eigen::VectorXd>& others, const Eigen::VectorXd& q) {
  double least = kFar;
  for (const Eigen::VectorXd& other : others) {
    double largest = 0;
    for (Eigen::Index j = 0; j < q.size(); ++j)
      largest = std::max(largest, std::abs(wrapped(other[j] - q[j])));
    least = std::min(least, largest);
  }
  return least;
}

TEST(Elimination, GivesBackTheConfigurationsThatPosesCameFrom) {
  std::mt19937_64 generator(kSeed);
  for (const InstructionSet& set : instruction_sets()) {
    int given_back = 0;
    for (int i = 0; i < kArms; ++i) {
      const kinematics::Chain chain = test::random_chain({.length_m = i == 0   ? 3e-3
                                                                      : i == 1 ? 30
                                                                               : 0.3},
                                                         generator);
      const LaneChain lanes = lane_chain(chain);
      const auto arm = elimination_of(chain, lanes, set.kernels);
      ASSERT_TRUE(arm) << set.name;
      for (int pose = 0; pose < kPoses; ++pose) {
        const Eigen::VectorXd q = test::random_configuration(chain, generator);
        const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
        given_back += nearest(branches_of(lanes, set.kernels, *arm, T), q) < 1e-5 ? 1 : 0;
      }
    }
    EXPECT_GE(given_back, 0.98 * kArms * kPoses) << set.name;
  }
}

TEST(Elimination, EveryInstructionSetLeadsToTheSameSolutions) {
  std::mt19937_64 generator(kSeed);
  int differing = 0, compared = 0;
  for (int i = 0; i < kArms; ++i) {
    const kinematics::Chain chain = test::random_chain({}, generator);
    std::vector<Solver> solvers;
    for (const InstructionSet& set : instruction_sets())
      solvers.emplace_back(chain, set.kernels);
    for (int pose = 0; pose < kPoses; ++pose) {
      const Eigen::Isometry3d T =
          kinematics::T_base_tip(chain, test::random_configuration(chain, generator));
      const Eigen::MatrixXd expected = solvers.front().solve(T).configurations;
      for (std::size_t k = 1; k < solvers.size(); ++k, ++compared) {
        const Eigen::MatrixXd found = solvers[k].solve(T).configurations;
        const bool same = found.cols() == expected.cols() && found.isApprox(expected, 1e-6);
        differing += same ? 0 : 1;
      }
    }
  }
  EXPECT_LE(differing, compared / 100);
}

/// As often as thousands of starts find a branch that the elimination has not, it has one that they
/// have not.
TEST(Elimination, FindsTheSolutionsThatDescentsFind) {
  std::mt19937_64 generator(kSeed);
  Eigen::Index of_elimination = 0, of_descents = 0;
  for (int i = 0; i < kArms; ++i) {
    const kinematics::Chain chain =
        test::random_chain({.limit = i % 2 == 0 ? std::numbers::pi : 2.0}, generator);
    const Solver solver(chain);
    const Solver descents(chain, instruction_sets().back().kernels, Solver::Engines::Descents);
    ASSERT_NE(solver.elimination(), nullptr);
    EXPECT_EQ(descents.elimination(), nullptr);
    for (int pose = 0; pose < kPoses; ++pose) {
      const Eigen::Isometry3d T =
          kinematics::T_base_tip(chain, test::random_configuration(chain, generator));
      of_elimination +=
          solver.solve(T, {.max_solutions = 64, .min_distance = 0}).configurations.cols();
      of_descents +=
          descents.solve(T, {.max_solutions = 0, .min_distance = 0}).configurations.cols();
    }
  }
  EXPECT_GT(of_descents, kArms * kPoses);
  EXPECT_GE(of_elimination, 0.997 * static_cast<double>(of_descents));
}

/// The resultant may come so near to 0 that one zero is proposed; two would be branches.
TEST(Elimination, HasNoBranchesWhereThePoseIsOutOfReach) {
  std::mt19937_64 generator(kSeed);
  const kinematics::Chain chain = test::random_chain({}, generator);
  const LaneChain lanes = lane_chain(chain);
  const SimdKernels kernels = instruction_sets().back().kernels;
  const LaneElimination arm = elimination_of(chain, lanes, kernels).value();
  for (int pose = 0; pose < kPoses; ++pose) {
    Eigen::Isometry3d T =
        kinematics::T_base_transfer(chain, test::random_configuration(chain, generator));
    T.translation() = 1.5 * reach_m(chain) * test::random_direction(generator);
    EXPECT_LE(branches_of(lanes, kernels, arm, T).size(), 1U);
  }
}

TEST(Elimination, IsForSixTurningJointsOnly) {
  std::mt19937_64 generator(kSeed);
  const SimdKernels kernels = instruction_sets().back().kernels;
  for (const test::RandomChain& wanted :
       {test::RandomChain{.joints = 5}, test::RandomChain{.joints = 7},
        test::RandomChain{.sliding_share = 1}}) {
    const kinematics::Chain chain = test::random_chain(wanted, generator);
    EXPECT_FALSE(elimination_of(chain, lane_chain(chain), kernels));
  }
}

/// All axes parallel: the equations say the same at every angle of joint 3.
TEST(Elimination, IsLeftOutWhereTheResultantSaysNothing) {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "tip";
  for (int j = 0; j < 6; ++j) {
    kinematics::Joint joint{.name = "joint" + std::to_string(j), .lower = -3, .upper = 3};
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.T_previous_joint.translation().x() = 0.2;
    parts.joints.push_back(joint);
  }
  const kinematics::Chain chain(parts);
  EXPECT_FALSE(elimination_of(chain, lane_chain(chain), instruction_sets().back().kernels));
}

TEST(Elimination, IsLeftOutWhereThereIsAClosedForm) {
  EXPECT_NE(Solver(test::arms::industrial()).closed_form(), nullptr);
  EXPECT_EQ(Solver(test::arms::industrial()).elimination(), nullptr);
}

/// Where the last branches of an arm have just met, what is left of them must not count as one
/// beyond the limits.
TEST(Elimination, LimitsAreNotBlamedWhereNoBranchIs) {
  std::mt19937_64 generator(kSeed);
  int unreached = 0;
  for (int i = 0; i < kArms; ++i) {
    const kinematics::Chain chain =
        with_limits(test::random_chain({}, generator), -std::numbers::pi, std::numbers::pi);
    const Solver solver(chain), narrow(with_limits(chain, -1.5, 1.5));
    ASSERT_NE(narrow.elimination(), nullptr);
    for (int pose = 0; pose < kPoses; ++pose) {
      Eigen::Isometry3d T =
          kinematics::T_base_tip(chain, test::random_configuration(chain, generator));
      const Eigen::Vector3d inside = T.translation();
      const auto is_solved_at = [&](double stretch) {
        T.translation() = stretch * inside;
        return solver.solve(T).configurations.cols() > 0;
      };
      double solved = 1, unsolved = 1.02 * reach_m(chain) / inside.norm();
      while (unsolved - solved > 1e-4) {
        const double middle = (solved + unsolved) / 2;
        (is_solved_at(middle) ? solved : unsolved) = middle;
      }
      for (const double beyond : {0.0, 1e-4, 1e-3, 1e-2}) {
        if (is_solved_at(unsolved + beyond))
          continue;
        ++unreached;
        EXPECT_NE(narrow.solve(T).reason, NoSolution::Limits) << "arm " << i << ", pose " << pose;
      }
    }
  }
  EXPECT_GE(unreached, 3 * kArms * kPoses);
}

TEST(Elimination, TellsThatLimitsAreInTheWay) {
  std::mt19937_64 generator(kSeed);
  const kinematics::Chain chain = test::random_chain({}, generator);
  const kinematics::Chain narrow = with_limits(chain, -0.01, 0.01);
  const Solver solver(narrow);
  ASSERT_NE(solver.elimination(), nullptr);
  int limits = 0;
  for (int pose = 0; pose < kPoses; ++pose) {
    const InverseSolutions found =
        solver.solve(kinematics::T_base_tip(chain, test::random_configuration(chain, generator)));
    EXPECT_EQ(found.configurations.cols(), 0);
    limits += found.reason == NoSolution::Limits ? 1 : 0;
  }
  EXPECT_GE(limits, 0.98 * kPoses);
}

}  // namespace
}  // namespace kinship::inverse::elimination_test
