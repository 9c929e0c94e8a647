#include "server/metrics/exposition.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace kinship::metrics {
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

}  // namespace
}  // namespace kinship::metrics
