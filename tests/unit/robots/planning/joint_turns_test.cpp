#include "robots/planning/joint_turns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kinship::planning::joint_turns_test {
namespace {

double largest_error(double largest_angle, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> angle(-largest_angle, largest_angle);
  double error = 0;
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const Eigen::Index count = 1 + repeat % static_cast<int>(kMaxDof);
    alignas(16) double angles[kMaxDof + 1];
    for (double& value : angles)
      value = angle(generator);
    JointTurns turns;
    turn_joints(angles, count, turns);
    for (Eigen::Index i = 0; i < count; ++i)
      error = std::max({error, std::abs(turns.sine[i] - std::sin(angles[i])),
                        std::abs(turns.cosine[i] - std::cos(angles[i]))});
  }
  return error;
}

TEST(JointTurns, AreTheLibrarysSinesAndCosines) {
  std::mt19937_64 generator(1);
  EXPECT_LT(largest_error(10, generator), 3e-16);
  EXPECT_LT(largest_error(1e4, generator), 3e-16);
}

TEST(JointTurns, QuarterTurnsAreExactUpToTheAngles) {
  for (int quarters = -9; quarters <= 9; ++quarters) {
    alignas(16) const double angles[2] = {quarters * M_PI / 2, 0};
    JointTurns turns;
    turn_joints(angles, 1, turns);
    EXPECT_NEAR(turns.sine[0], std::sin(angles[0]), 3e-16) << quarters;
    EXPECT_NEAR(turns.cosine[0], std::cos(angles[0]), 3e-16) << quarters;
  }
}

}  // namespace
}  // namespace kinship::planning::joint_turns_test
