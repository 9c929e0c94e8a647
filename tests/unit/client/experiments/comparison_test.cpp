#include "client/experiments/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "client/experiments/comparison_table.hpp"

namespace kinship::experiments::comparison_test {
namespace {

ProblemResult attempt(const std::string& name, bool solved, std::uint64_t checks, double time_s) {
  ProblemResult result;
  result.name = name;
  result.solved = solved;
  result.collision_checks = checks;
  result.planning_time_s = time_s;
  return result;
}

ProblemResult guided_attempt(const std::string& name, bool solved, std::uint64_t checks,
                             double time_s) {
  ProblemResult result = attempt(name, solved, checks, time_s);
  result.distribution_id = Digest{};
  result.share = 0.9;
  return result;
}

const std::vector<ProblemResult> kUniform = {
    attempt("a", true, 1000, 1), attempt("b", true, 3000, 3), attempt("c", false, 60000, 50)};
const std::vector<ProblemResult> kGuided = {guided_attempt("c", true, 2000, 2),
                                            guided_attempt("a", true, 500, 0.5),
                                            guided_attempt("b", true, 1500, 1.5)};

Comparison compared(const std::vector<ProblemResult>& uniform,
                    const std::vector<ProblemResult>& guided) {
  return compare(uniform, guided).value_or_throw();
}

std::string table_of(const Comparison& comparison) {
  std::ostringstream out;
  write_table(comparison, {}, out);
  return out.str();
}

TEST(Comparison, ADistributionWithShareZeroIsNoGuidance) {
  std::vector<ProblemResult> unused = kGuided;
  unused[1].share = 0;
  EXPECT_EQ(compared(kUniform, unused).guided.with_guidance, 2U);
}

TEST(Comparison, PairsByNameInWhateverOrder) {
  const Comparison comparison = compared(kUniform, kGuided);
  EXPECT_EQ(comparison.pairs, 3U);
  EXPECT_EQ(comparison.uniform.solved, 2U);
  EXPECT_EQ(comparison.guided.solved, 3U);
  EXPECT_EQ(comparison.checks_test.rank_sum_plus, 6);  // uniform is worse in every pair
  EXPECT_EQ(comparison.checks_test.p, 0.25);
}

TEST(Comparison, MeansAreCappedAndMediansRankUnsolvedWorst) {
  const Comparison comparison = compared(kUniform, kGuided);
  EXPECT_DOUBLE_EQ(comparison.uniform.mean_checks, 64000.0 / 3);
  EXPECT_DOUBLE_EQ(comparison.uniform.median_checks, 3000);
  EXPECT_DOUBLE_EQ(comparison.mean_checks_ratio, 64000.0 / 4000.0);
  EXPECT_DOUBLE_EQ(comparison.median_time_ratio, 2);
}

TEST(Comparison, AnUnsolvedAttemptWithFewChecksStillRanksWorst) {
  const Comparison comparison =
      compared({attempt("a", false, 10, 0.1)}, {guided_attempt("a", true, 5000, 5)});
  EXPECT_EQ(comparison.checks_test.rank_sum_plus, 1);
  EXPECT_TRUE(std::isinf(comparison.uniform.median_checks));
}

TEST(Comparison, BothUnsolvedIsATie) {
  const Comparison comparison =
      compared({attempt("a", false, 60000, 9)}, {guided_attempt("a", false, 60001, 8)});
  EXPECT_EQ(comparison.checks_test.dropped, 1U);
  EXPECT_EQ(comparison.checks_test.p, 1);
}

TEST(Comparison, NamesWhatOnlyOneSideAnswered) {
  auto uniform = kUniform;
  uniform.push_back(attempt("d", true, 1, 1));
  auto guided = kGuided;
  guided.push_back(guided_attempt("e", true, 1, 1));
  const Comparison comparison = compared(uniform, guided);
  EXPECT_EQ(comparison.pairs, 3U);
  EXPECT_EQ(comparison.unpaired, (std::vector<std::string>{"d", "e"}));
}

TEST(Comparison, RefusesDuplicatesAndStrangers) {
  EXPECT_FALSE(compare({kUniform[0], kUniform[0]}, kGuided));
  EXPECT_FALSE(compare({attempt("x", true, 1, 1)}, kGuided));
  EXPECT_FALSE(compare({}, {}));
}

TEST(ComparisonTable, ShowsEveryFigureInItsColumn) {
  const std::string table = table_of(compared(kUniform, kGuided));
  EXPECT_EQ(
      table,
      "3 problems, each planned with both\n"
      "\n"
      "                                uniform     guided    ratio          p\n"
      "  solved                            2/3        3/3\n"
      "  collision checks, mean         21 333      1 333    16.00     0.2500\n"
      "  collision checks, median        3 000      1 500     2.00\n"
      "  planning time, mean            18.0 s     1.33 s    13.50     0.2500\n"
      "  planning time, median          3.00 s     1.50 s     2.00\n"
      "\n"
      "ratio: uniform / guided. p: two-sided Wilcoxon signed-rank test, unsolved ranked worst "
      "(exact, 3 pairs that differ).\n"
      "An unsolved attempt counts in a mean with what it had used when it gave up: that mean "
      "is a lower bound. In a median it is worse than all that are solved.\n");
}

TEST(ComparisonTable, TimesHaveTheUnitThatFitsThemAndHalvesRoundUp) {
  const std::string table = table_of(
      compared({attempt("a", true, 1810, 0.00042), attempt("b", true, 1811, 0.00044)},
               {guided_attempt("a", true, 10, 2e-6), guided_attempt("b", true, 11, 4e-6)}));
  EXPECT_NE(table.find("  collision checks, median        1 811         11"), std::string::npos)
      << table;
  EXPECT_NE(table.find("  planning time, mean            430 µs    3.00 µs   143.33"),
            std::string::npos)
      << table;
}

ProblemResult not_planned(ProblemResult result, NotPlanned why, const std::string& reason) {
  result.not_planned = why;
  result.reason = reason;
  return result;
}

TEST(Comparison, LeavesOutWhatASideBeganNoSearchFor) {
  auto uniform = kUniform;
  auto guided = kGuided;
  uniform.push_back(not_planned(attempt("d", false, 1, 0), NotPlanned::StartCollides, "collides"));
  guided.push_back(not_planned(attempt("d", false, 1, 0), NotPlanned::StartCollides, "collides"));
  uniform.push_back(attempt("e", true, 7, 1));
  guided.push_back(not_planned(attempt("e", false, 0, 0), NotPlanned::Error, "broken"));
  const Comparison comparison = compared(uniform, guided);
  EXPECT_EQ(comparison.pairs, 3U);
  EXPECT_EQ(comparison.uniform.mean_checks, compared(kUniform, kGuided).uniform.mean_checks);
  EXPECT_EQ(comparison.checks_test.p, 0.25);
  const std::string table = table_of(comparison);
  EXPECT_NE(table.find("\n2 problems could not be planned and are left out (start collides: 1, "
                       "error: 1).\n  d: collides\n  e: broken\n"),
            std::string::npos)
      << table;
  std::ostringstream json;
  write_json(comparison, {}, json);
  EXPECT_NE(json.str().find(R"("not_planned":{"start_collides":1,"error":1}})"), std::string::npos)
      << json.str();
}

TEST(Comparison, SaysWhyThereIsNothingToCompare) {
  const std::vector<ProblemResult> colliding = {
      not_planned(attempt("d", false, 1, 0), NotPlanned::StartCollides, "collides")};
  EXPECT_EQ(compare(colliding, colliding).error().message,
            "no problem could be planned (start collides: 1)");
}

TEST(ComparisonTable, WhatElseWasComparedHasALineBelow) {
  const std::vector<AlsoCompared> also = {{"retreat alone", compared(kUniform, kUniform)},
                                          {"mixture alone", compared(kUniform, kGuided)}};
  std::ostringstream out;
  write_table(compared(kUniform, kGuided), also, out);
  const std::string table = out.str();
  EXPECT_TRUE(table.starts_with(table_of(compared(kUniform, kGuided)))) << "above, as without";
  EXPECT_NE(table.find("  mixture alone             3/3    1 333    16.00     1.33 s    13.50\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("  retreat alone             2/3   21 333     1.00     18.0 s     1.00\n"),
            std::string::npos)
      << table;
  EXPECT_EQ(table_of(compared(kUniform, kGuided)).find("alone"), std::string::npos);
}

TEST(ComparisonJson, HasWhatElseWasCompared) {
  std::ostringstream out;
  write_json(compared(kUniform, kGuided), {{"say \"alone\"", compared(kUniform, kUniform)}}, out);
  EXPECT_NE(out.str().find(
                R"(,"also":[{"name":"say \u0022alone\u0022","pairs":3,"uniform":{"solved":2,)"),
            std::string::npos)
      << out.str();
  EXPECT_NE(out.str().find(R"("ratio":{"mean_checks":1,)"), std::string::npos);
}

TEST(ComparisonTable, SaysWhenGuidanceWasMissing) {
  const std::string table = table_of(compared(kUniform, kUniform));
  EXPECT_NE(table.find("Only 0 of the 3 guided attempts drew"), std::string::npos);
  EXPECT_NE(table.find("1.00"), std::string::npos);
}

TEST(ComparisonTable, SaysWhenOnlyOneSideIsProven) {
  EXPECT_EQ(table_of(compared(kUniform, kGuided)).find("proven"), std::string::npos);
  std::vector<ProblemResult> proven = kUniform;
  for (ProblemResult& result : proven)
    result.proven = result.solved;
  EXPECT_NE(table_of(compared(proven, kGuided)).find("Of 2 pairs of paths one is proven"),
            std::string::npos);
}

TEST(ComparisonTable, SaysUnsolvedInsteadOfInfinity) {
  const std::string table =
      table_of(compared({attempt("a", false, 60000, 9)}, {guided_attempt("a", true, 1000, 1)}));
  EXPECT_NE(table.find("unsolved"), std::string::npos);
  EXPECT_NE(table.find("inf"), std::string::npos);
}

TEST(ComparisonJson, IsOneDocumentWithNullForInfinity) {
  std::ostringstream out;
  write_json(compared({attempt("a", false, 60000, 9)}, {guided_attempt("a", true, 1000, 1)}), {},
             out);
  EXPECT_EQ(out.str(),
            "{\"pairs\":1,\"uniform\":{\"solved\":0,\"with_guidance\":0,\"mean_checks\":60000,"
            "\"median_checks\":null,\"mean_time_s\":9,\"median_time_s\":null},"
            "\"guided\":{\"solved\":1,\"with_guidance\":1,\"mean_checks\":1000,"
            "\"median_checks\":1000,\"mean_time_s\":1,\"median_time_s\":1},"
            "\"ratio\":{\"mean_checks\":60,\"median_checks\":null,\"mean_time\":9,"
            "\"median_time\":null},"
            "\"wilcoxon_checks\":{\"p\":1,\"pairs\":1,\"dropped\":0,\"rank_sum_plus\":1,"
            "\"rank_sum_minus\":0,\"method\":\"exact\"},"
            "\"wilcoxon_time\":{\"p\":1,\"pairs\":1,\"dropped\":0,\"rank_sum_plus\":1,"
            "\"rank_sum_minus\":0,\"method\":\"exact\"},\"unpaired\":0,\"not_planned\":{}}\n");
}

}  // namespace
}  // namespace kinship::experiments::comparison_test
