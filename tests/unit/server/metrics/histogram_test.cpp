#include "server/metrics/histogram.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <thread>
#include <vector>

namespace kinship::metrics {
namespace {

std::uint64_t all_of(const Histogram& histogram) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i <= Histogram::kBounds_s.size(); ++i)
    sum += histogram.count(i);
  return sum;
}

TEST(Histogram, AValueOnABoundBelongsBelowIt) {
  Histogram histogram;
  for (const double bound : Histogram::kBounds_s)
    histogram.observe(bound);
  for (std::size_t i = 0; i < Histogram::kBounds_s.size(); ++i)
    EXPECT_EQ(histogram.count(i), 1U) << Histogram::kBounds_s[i];
  histogram.observe(100.1);
  EXPECT_EQ(histogram.count(Histogram::kBounds_s.size()), 1U);
}

TEST(Histogram, WhatIsNoDurationCountsAsNone) {
  Histogram histogram;
  histogram.observe(-1.0);
  histogram.observe(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(histogram.count(0), 2U);
  EXPECT_EQ(histogram.sum_s(), 0.0);
  histogram.observe(std::numeric_limits<double>::infinity());
  EXPECT_EQ(histogram.count(Histogram::kBounds_s.size()), 1U);
}

TEST(Histogram, LosesNothingOfSeveralThreads) {
  constexpr int kThreads = 4, kEach = 10'000;
  Histogram histogram;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i)
    threads.emplace_back([&histogram] {
      for (int j = 0; j < kEach; ++j)
        histogram.observe(std::chrono::milliseconds(j % 2));
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(all_of(histogram), std::uint64_t{kThreads} * kEach);
  EXPECT_NEAR(histogram.sum_s(), 0.0005 * kThreads * kEach, 1e-6);
}

}  // namespace
}  // namespace kinship::metrics
