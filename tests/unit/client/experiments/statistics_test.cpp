#include "client/experiments/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace kinship::experiments::statistics_test {
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

TEST(Statistics, AMeansIntervalHoldsItAndNarrowsWithMoreValues) {
  std::vector<double> values;
  for (int i = 0; i < 25; ++i)
    values.push_back(i % 5);  // standard deviation 1.41, of the mean 0.28
  const MeanInterval few = mean_interval(values);
  EXPECT_DOUBLE_EQ(few.mean, 2);
  EXPECT_NEAR(few.low, 2 - 1.96 * 0.283, 0.05);
  EXPECT_NEAR(few.high, 2 + 1.96 * 0.283, 0.05);
  for (int i = 0; i < 475; ++i)
    values.push_back(i % 5);
  const MeanInterval many = mean_interval(values);
  EXPECT_LT(many.high - many.low, 0.5 * (few.high - few.low));
  const MeanInterval equal = mean_interval({7, 7, 7});
  EXPECT_EQ(equal.low, 7);
  EXPECT_EQ(equal.high, 7);
}

TEST(Statistics, RefuseNothingAndNotANumber) {
  EXPECT_THROW(mean({}), std::invalid_argument);
  EXPECT_THROW(median({}), std::invalid_argument);
  EXPECT_THROW(mean_interval({}), std::invalid_argument);
  EXPECT_THROW(median({1, std::nan("")}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::experiments::statistics_test
