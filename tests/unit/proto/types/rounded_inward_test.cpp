#include "proto/types/rounded_inward.hpp"

#include <gtest/gtest.h>

#include <random>

namespace kinship::rounded_inward_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(RoundedInward, StaysBetweenTheLimitsAndWithinAnUlpOfTheNumber) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> anywhere(-3, 3);
  int moved = 0;
  for (int i = 0; i < 1000; ++i) {
    const double limit = anywhere(generator);
    for (const auto& [lower, upper] : {std::pair(limit, 4.0), std::pair(-4.0, limit)}) {
      const double rounded = rounded_inward(limit, lower, upper);
      EXPECT_GE(rounded, lower);
      EXPECT_LE(rounded, upper);
      EXPECT_LT(std::abs(rounded - limit), 5e-7);
      moved += rounded != static_cast<float>(limit) ? 1 : 0;
    }
  }
  EXPECT_GT(moved, 900);  // of 2000, one of each pair
}

TEST(RoundedInward, ANumberOutsideOrWithoutLimitsIsOnlyRounded) {
  EXPECT_EQ(rounded_inward(0.1, -kInfinity, kInfinity), 0.1F);
  EXPECT_EQ(rounded_inward(0.1, -1, 0.05), 0.1F);
  EXPECT_EQ(rounded_inward(0.1, 0.2, 1), 0.1F);
}

TEST(RoundedInward, WhereNoFloatLiesBetweenTheLimitsTheNearestStands) {
  EXPECT_EQ(rounded_inward(0.1, 0.1, 0.1), 0.1F);
  EXPECT_EQ(rounded_inward(0.7, 0.7, 0.7), 0.7F);
}

}  // namespace
}  // namespace kinship::rounded_inward_test
