#include "server/metrics/exposition.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/metrics/histogram.hpp"

namespace kinship::metrics::metrics_test {
namespace {

TEST(Exposition, WritesAFamilyWithHelpTypeAndSamples) {
  Exposition page;
  page.family("kinship_fetches_total", Type::Counter, "Fetches, by outcome.");
  page.sample(std::uint64_t{3}, {{"outcome", "memory"}});
  page.sample(0.5, {{"outcome", "none"}, {"robot", "panda"}});
  page.gauge("kinship_store_bytes", "Of its file.", std::uint64_t{18446744073709551615U});
  EXPECT_EQ(page.text(),
            "# HELP kinship_fetches_total Fetches, by outcome.\n"
            "# TYPE kinship_fetches_total counter\n"
            "kinship_fetches_total{outcome=\"memory\"} 3\n"
            "kinship_fetches_total{outcome=\"none\",robot=\"panda\"} 0.5\n"
            "# HELP kinship_store_bytes Of its file.\n"
            "# TYPE kinship_store_bytes gauge\n"
            "kinship_store_bytes 18446744073709551615\n");
}

TEST(Exposition, EscapesWhatOthersHaveNamed) {
  Exposition page;
  page.family("a", Type::Gauge, "back\\slash and\nline, \"quoted\"");
  page.sample(1.0, {{"task", "a\"b\\c\nd"}});
  EXPECT_EQ(page.text(),
            "# HELP a back\\\\slash and\\nline, \"quoted\"\n"
            "# TYPE a gauge\n"
            "a{task=\"a\\\"b\\\\c\\nd\"} 1\n");
}

TEST(Exposition, WritesNumbersThatAreNone) {
  Exposition page;
  page.family("a", Type::Gauge, "");
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity(), 0.1, 1e-300})
    page.sample(value);
  EXPECT_TRUE(page.text().ends_with("a NaN\na +Inf\na -Inf\na 0.1\na 1e-300\n")) << page.text();
}

TEST(Exposition, BucketsOfAHistogramAddUp) {
  Histogram histogram;
  for (const double seconds : {0.0002, 0.0002, 0.7, 1000.0})
    histogram.observe(seconds);
  Exposition page;
  page.family("fit_seconds", Type::Histogram, "");
  page.histogram(histogram, {{"robot", "ur5e"}});
  const auto has = [&page](const char* line) {
    return page.text().find(line) != std::string::npos;
  };
  EXPECT_TRUE(has("fit_seconds_bucket{robot=\"ur5e\",le=\"0.0001\"} 0\n")) << page.text();
  EXPECT_TRUE(has("fit_seconds_bucket{robot=\"ur5e\",le=\"0.00025\"} 2\n")) << page.text();
  EXPECT_TRUE(has("fit_seconds_bucket{robot=\"ur5e\",le=\"1\"} 3\n")) << page.text();
  EXPECT_TRUE(has("fit_seconds_bucket{robot=\"ur5e\",le=\"100\"} 3\n")) << page.text();
  EXPECT_TRUE(has("fit_seconds_bucket{robot=\"ur5e\",le=\"+Inf\"} 4\n")) << page.text();
  EXPECT_TRUE(has("fit_seconds_count{robot=\"ur5e\"} 4\n")) << page.text();
  EXPECT_TRUE(has("fit_seconds_sum{robot=\"ur5e\"} 1000.700")) << page.text();
}

TEST(Exposition, RefusesNamesThatBreakTheConventions) {
  Exposition page;
  EXPECT_THROW(page.sample(1.0), std::logic_error);
  EXPECT_THROW(page.family("with-dash", Type::Gauge, ""), std::logic_error);
  EXPECT_THROW(page.family("1st", Type::Gauge, ""), std::logic_error);
  EXPECT_THROW(page.family("reports", Type::Counter, ""), std::logic_error);
  EXPECT_THROW(page.family("reports_total", Type::Gauge, ""), std::logic_error);
  page.family("twice", Type::Gauge, "");
  EXPECT_THROW(page.family("twice", Type::Gauge, ""), std::logic_error);
  EXPECT_THROW(page.sample(1.0, {{"a b", "c"}}), std::logic_error);
  EXPECT_THROW(page.histogram(Histogram()), std::logic_error);
}

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
}  // namespace kinship::metrics::metrics_test
