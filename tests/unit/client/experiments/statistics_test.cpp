#include "client/experiments/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace kinship::experiments {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Statistics, MeanIsTheSumOverTheNumber) { EXPECT_EQ(mean({1, 2, 6}), 3); }

TEST(Statistics, MedianIsTheMiddleWhateverTheOrder) {
  EXPECT_EQ(median({9, 1, 5}), 5);
  EXPECT_EQ(median({9, 1, 5, 6}), 5.5);
  EXPECT_EQ(median({4}), 4);
}

TEST(Statistics, MedianStaysFiniteWhileFewerThanHalfAreInfinite) {
  EXPECT_EQ(median({kInfinity, 2, 1}), 2);
  EXPECT_EQ(median({kInfinity, kInfinity, 1}), kInfinity);
  EXPECT_EQ(median({kInfinity, kInfinity, 1, 2}), kInfinity);
}

TEST(Statistics, RefuseNothingAndNotANumber) {
  EXPECT_THROW(mean({}), std::invalid_argument);
  EXPECT_THROW(median({}), std::invalid_argument);
  EXPECT_THROW(median({1, std::nan("")}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::experiments
