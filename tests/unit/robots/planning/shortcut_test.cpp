#include "robots/planning/shortcut.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::shortcut_test {
namespace {

using test_support::at;
using test_support::WallWorld;

constexpr double kStep = 0.05;

/// From left to right through the gap, with detours that differ from seed to seed.
Eigen::MatrixXd detour(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> left(-1, -0.2), right(0.2, 1), y(-1, 1);
  Eigen::MatrixXd path(2, 8);
  path << at(-0.9, 0), at(left(generator), y(generator)), at(left(generator), y(generator)),
      at(-0.15, 0.7), at(0.15, 0.7), at(right(generator), y(generator)),
      at(right(generator), y(generator)), at(0.9, 0);
  return path;
}

TEST(Shortcut, NeverLengthensStaysFreeAndKeepsTheEnds) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    WallWorld world;
    const Eigen::MatrixXd path = detour(seed);
    ASSERT_TRUE(world.path_is_free(path, kStep));
    std::mt19937_64 generator(seed);
    const auto summary = shortcut(path, world.is_free(), {kStep, 300}, generator);
    EXPECT_LE(path_length(summary.waypoints), path_length(path) + 1e-9);
    EXPECT_TRUE(world.path_is_free(summary.waypoints, kStep)) << "seed " << seed;
    EXPECT_EQ(summary.waypoints.leftCols(1), path.leftCols(1));
    EXPECT_EQ(summary.waypoints.rightCols(1), path.rightCols(1));
  }
}

TEST(Shortcut, CountsItsChecksAndRespectsItsBudget) {
  for (const std::uint64_t budget : {0u, 1u, 10u, 50u, 300u}) {
    WallWorld world;
    std::mt19937_64 generator(1);
    const auto summary = shortcut(detour(1), world.is_free(), {kStep, budget}, generator);
    EXPECT_EQ(summary.collision_checks, world.asked);
    EXPECT_LE(world.asked, budget);
  }
}

TEST(Shortcut, ComesNearTheShortestPathWithManyChecks) {
  WallWorld world;
  std::mt19937_64 generator(2);
  const auto summary = shortcut(detour(2), world.is_free(), {kStep, 100'000}, generator);
  // Around the lower corners of the gap, (+-0.1, 0.6).
  const double shortest = 2 * std::hypot(0.8, 0.6) + 0.2;
  EXPECT_LT(path_length(summary.waypoints), 1.05 * shortest);
}

TEST(Shortcut, MakesOneSegmentOfADetourInTheOpen) {
  WallWorld world;
  std::mt19937_64 generator(3);
  Eigen::MatrixXd path(2, 3);
  path << at(-0.9, -0.9), at(-0.2, 0), at(-0.9, 0.9);
  const auto summary = shortcut(path, world.is_free(), {kStep, 10'000}, generator);
  EXPECT_NEAR(path_length(summary.waypoints), 1.8, 1e-3);
  EXPECT_LE(summary.waypoints.cols(), 12);
}

TEST(Shortcut, LeavesAStraightPathAloneWithoutAsking) {
  WallWorld world;
  std::mt19937_64 generator(4);
  Eigen::MatrixXd path(2, 2);
  path << at(-0.9, -0.9), at(-0.9, 0.9);
  const auto summary = shortcut(path, world.is_free(), {kStep, 300}, generator);
  EXPECT_EQ(summary.waypoints, path);
  EXPECT_EQ(world.asked, 0u);
}

TEST(Shortcut, EqualSeedEqualPath) {
  WallWorld world;
  std::mt19937_64 one(5), two(5);
  EXPECT_EQ(shortcut(detour(5), world.is_free(), {kStep, 300}, one).waypoints,
            shortcut(detour(5), world.is_free(), {kStep, 300}, two).waypoints);
}

}  // namespace
}  // namespace kinship::planning::shortcut_test
