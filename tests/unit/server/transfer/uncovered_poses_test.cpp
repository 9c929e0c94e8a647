#include "server/transfer/uncovered_poses.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/robots.hpp"

namespace kinship::transfer::uncovered_poses_test {
namespace {

constexpr std::uint64_t kSeed = 3;
constexpr int kMaxDraws = 10'000;

/// Poses of a Panda by what they cost: e, found at once; h, found with patience only (joints at
/// their limits); f, out of reach by a few centimetres, as patience finds out.
class UncoveredPoses : public testing::Test {
 protected:
  RandomSolutions look(const Eigen::Isometry3d& T_base_transfer, bool exhaustive) {
    return random_solutions(pair_.target_solver(), T_base_transfer, parameters_, kSeed, counted_,
                            exhaustive);
  }

  Eigen::Isometry3d pose(char kind) {
    for (int i = 0; i < kMaxDraws; ++i) {
      Eigen::VectorXd q = test::random_configuration(arm_, generator_);
      for (Eigen::Index j = 0; kind == 'h' && j < q.size(); ++j)
        q[j] = generator_() % 2 == 0 ? arm_.lower()[j] : arm_.upper()[j];
      Eigen::Isometry3d T = kinematics::T_base_transfer(arm_, q);
      if (kind == 'f')
        T.translation() *= 1.3;
      const bool at_once = look(T, false).configurations.cols() > 0;
      const bool at_all = at_once || look(T, true).configurations.cols() > 0;
      if (at_once == (kind == 'e') && at_all == (kind != 'f'))
        return T;
    }
    throw std::runtime_error(std::string("no pose of kind ") + kind);
  }

  PathPoses path(const std::string& kinds) {
    PathPoses poses;
    for (const char kind : kinds)
      poses.T_base_transfer.push_back(pose(kind));
    return poses;
  }

  /// 1 where there are configurations. Wherever there are, patience alone gives the same.
  std::string solved(const PathPoses& poses, const std::vector<bool>& covered) {
    const auto found = solve_uncovered(pair_, poses, covered, parameters_, kSeed, counted_);
    std::string result;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool any = found[i].configurations.cols() > 0;
      EXPECT_EQ(found[i].reason == inverse::NoSolution::None, any || covered[i]);
      if (any) {
        EXPECT_EQ(found[i].configurations, look(poses.T_base_transfer[i], true).configurations);
      }
      result += any ? '1' : '0';
    }
    return result;
  }

  std::string solved(const std::string& kinds) {
    return solved(path(kinds), std::vector<bool>(kinds.size(), false));
  }

 private:
  const kinematics::Chain arm_ = test::model_chain("panda");
  const ArmPair pair_{arm_, arm_};
  const TransferParameters parameters_{};
  const Filters none_{};
  CountedFilters counted_{none_};
  std::mt19937_64 generator_{11};
};

TEST_F(UncoveredPoses, BesideAReachedPosePatienceLooksOnBothWays) {
  EXPECT_EQ(solved("feff"), "0100");
  EXPECT_EQ(solved("ffhhehhff"), "001111100");
}

TEST_F(UncoveredPoses, TheEndsOfAPathAreLookedAtWithPatience) {
  EXPECT_EQ(solved("hhff"), "1100");
  EXPECT_EQ(solved("ffhh"), "0011");
  EXPECT_EQ(solved("h"), "1");
}

TEST_F(UncoveredPoses, AmongPosesWithoutASolutionPatienceIsSpared) {
  EXPECT_EQ(solved("effhff"), "100000");
}

TEST_F(UncoveredPoses, WhatATrackCoversIsReachedAndNotSolvedAgain) {
  const PathPoses poses = path("ffhef");
  EXPECT_EQ(solved(poses, {false, false, false, true, false}), "00100");
}

}  // namespace
}  // namespace kinship::transfer::uncovered_poses_test
