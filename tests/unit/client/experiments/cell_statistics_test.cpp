#include "client/experiments/analysis/cell_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace kinship::experiments::cell_statistics_test {
namespace {

constexpr std::uint64_t kMaxChecks = 1000;

/// Ten instances with two seeds each; checks are `first` + the index, `last` of them unsolved.
std::vector<QueryResult> results(const std::string& guidance, std::uint64_t first,
                                 std::uint32_t unsolved = 0) {
  std::vector<QueryResult> list;
  for (std::uint32_t i = 0; i < 10; ++i)
    for (std::uint32_t seed = 0; seed < 2; ++seed) {
      QueryResult result;
      result.key = {"arm", guidance, "task-" + std::to_string(i), seed};
      result.solved = i >= unsolved;
      result.checks = first + i;
      result.cpu_s = 0.5;
      result.length = 3;
      list.push_back(result);
    }
  return list;
}

CellResults cell(const std::string& guidance, std::uint64_t first, std::uint32_t unsolved = 0) {
  return collect_cell(results(guidance, first, unsolved), "arm", guidance, kMaxChecks);
}

TEST(CellStatistics, AnUnsolvedQueryCountsTheLimit) {
  const CellResults collected = cell("uniform", 0, 2);
  EXPECT_EQ(collected.queries(), 20U);
  EXPECT_EQ(collected.solved_queries(), 16U);
  EXPECT_EQ(collected.checks[0], (std::vector<double>{1000, 1000}));
  EXPECT_EQ(collected.checks[2], (std::vector<double>{2, 2}));
  EXPECT_TRUE(collected.lengths[0].empty());
}

TEST(CellStatistics, OtherRobotsAndGuidancesAreNotCollected) {
  std::vector<QueryResult> all = results("uniform", 5);
  const std::vector<QueryResult> more = results("panda", 7);
  all.insert(all.end(), more.begin(), more.end());
  EXPECT_EQ(collect_cell(all, "arm", "panda", kMaxChecks).checks[0][0], 7);
  EXPECT_TRUE(collect_cell(all, "other", "panda", kMaxChecks).instances.empty());
}

TEST(CellStatistics, RatioOfAPairIsThatOfTheMeans) {
  const PairRatio pair = compare_cells(cell("uniform", 400), cell("panda", 100));
  EXPECT_NEAR(pair.checks_ratio, 404.5 / 104.5, 1e-12);
  EXPECT_LT(pair.low, pair.checks_ratio);
  EXPECT_GT(pair.high, pair.checks_ratio);
  EXPECT_EQ(pair.checks_test.pairs, 10U);  // instances, not seeds
  EXPECT_LT(pair.checks_test.p, 0.01);
  EXPECT_EQ(pair.success_p, 1);
}

TEST(CellStatistics, GeometricMeanOverPairs) {
  const CellResults uniform = cell("uniform", 400), a = cell("a", 100), b = cell("b", 300);
  const double expected = std::sqrt((404.5 / 104.5) * (404.5 / 304.5));
  const GeometricMean both =
      geometric_mean_ratio({{&uniform, &a}, {&uniform, &b}}, Quantity::Checks);
  EXPECT_NEAR(both.value, expected, 1e-12);
  EXPECT_EQ(both.pairs, 2U);
  EXPECT_LT(both.low, both.value);
  EXPECT_GT(both.high, both.value);
  EXPECT_NEAR(geometric_mean_ratio({{&uniform, &a}}, Quantity::Cpu).value, 1, 1e-12);
  EXPECT_EQ(geometric_mean_ratio({}, Quantity::Checks).pairs, 0U);
}

TEST(CellStatistics, DifferentInstancesAreNotCompared) {
  CellResults other = cell("panda", 100);
  other.instances[3] = "another";
  EXPECT_THROW(compare_cells(cell("uniform", 400), other), std::invalid_argument);
  other = cell("panda", 100);
  other.checks[3].pop_back();
  EXPECT_THROW(compare_cells(cell("uniform", 400), other), std::invalid_argument);
}

TEST(CellStatistics, SuccessIsComparedQueryByQuery) {
  const PairRatio pair = compare_cells(cell("uniform", 400, 3), cell("panda", 100));
  EXPECT_EQ(pair.guided_only, 6U);
  EXPECT_EQ(pair.uniform_only, 0U);
  EXPECT_NEAR(pair.success_p, 2 * std::pow(0.5, 6), 1e-12);
}

// Values of the binomial distribution with p = 1/2, by hand.
TEST(CellStatistics, McNemarIsTheTwoSidedBinomialTest) {
  EXPECT_EQ(mcnemar_p(0, 0), 1);
  EXPECT_EQ(mcnemar_p(3, 3), 1);
  EXPECT_NEAR(mcnemar_p(5, 0), 2.0 / 32, 1e-12);
  EXPECT_NEAR(mcnemar_p(1, 5), 2 * (1.0 + 6) / 64, 1e-12);
  EXPECT_NEAR(mcnemar_p(5, 1), mcnemar_p(1, 5), 1e-15);
}

}  // namespace
}  // namespace kinship::experiments::cell_statistics_test
