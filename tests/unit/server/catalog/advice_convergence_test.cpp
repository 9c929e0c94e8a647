// How soon the recommended share is right, in draws with fixed seeds. Checks are log-normal about
// the means and medians of a shelf task: uniform 4299 and 2726, guided 2938 and 1810.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "proto/evidence/attempt_window.hpp"
#include "server/catalog/advice_rule.hpp"

namespace kinship::catalog::advice_convergence_test {
namespace {

constexpr double kProfileShare = 0.9;
constexpr int kDraws = 1000;

struct Course {
  double guided_to_uniform = 1;  ///< mean checks
  int each = 100;                ///< attempts of each mode, in random order
  double dearer = 1;             ///< both modes, from the middle on
  std::uint64_t absurd = 0;      ///< checks of one guided report near the end; 0: none
  double cap = 1e18;             ///< checks after which an attempt gives up
};

/// Checks of an attempt.
double draw(bool is_guided, const Course& course, std::mt19937_64& generator) {
  const double mean = 4299 * (is_guided ? course.guided_to_uniform : 1);
  const double mean_to_median = is_guided ? 2938.0 / 1810 : 4299.0 / 2726;
  std::lognormal_distribution<double> checks(std::log(mean / mean_to_median),
                                             std::sqrt(2 * std::log(mean_to_median)));
  return checks(generator);
}

double share_of(const evidence::AttemptWindow& window) {
  return advise({}, {.attempts = window.recent(), .guided = 99, .control = 99, .planner = {}},
                kProfileShare)
      .recommended_share;
}

double share_after(const Course& course, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  const int count = 2 * course.each;
  std::vector<bool> is_guided(static_cast<std::size_t>(count));
  std::fill_n(is_guided.begin(), course.each, true);
  std::shuffle(is_guided.begin(), is_guided.end(), generator);
  evidence::AttemptWindow window;
  for (int i = 0; i < count; ++i) {
    const bool guided = is_guided[static_cast<std::size_t>(i)];
    const double needed = draw(guided, course, generator) * (i < course.each ? 1 : course.dearer);
    window.add(guided ? SamplingMode::Guided : SamplingMode::Control, needed <= course.cap,
               static_cast<std::uint64_t>(std::min(needed, course.cap)));
    if (i == count - 3 && course.absurd > 0)
      window.add(SamplingMode::Guided, true, course.absurd);
  }
  return share_of(window);
}

/// In parts of all draws.
struct Outcome {
  double full = 0, below_fifth = 0, at_most_tenth = 0;
};

Outcome outcome_of(const Course& course) {
  Outcome outcome;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const double share = share_after(course, seed);
    outcome.full += share >= kProfileShare - 1e-9 ? 1.0 / kDraws : 0;
    outcome.below_fifth += share < 0.2 ? 1.0 / kDraws : 0;
    outcome.at_most_tenth += share <= 0.1 ? 1.0 / kDraws : 0;
  }
  std::printf("ratio %.2f, %d of each, dearer %.0f: full %.3f, < 0.2 %.3f, <= 0.1 %.3f\n",
              course.guided_to_uniform, course.each, course.dearer, outcome.full,
              outcome.below_fifth, outcome.at_most_tenth);
  return outcome;
}

void expect_trusted(const Course& course) {
  const Outcome outcome = outcome_of(course);
  EXPECT_GE(outcome.full, 0.95);
  EXPECT_LE(outcome.below_fifth, 0.01);
}

TEST(AdviceConvergence, GoodGuidanceHasItsFullShareAfterAHundredOfEach) {
  expect_trusted({.guided_to_uniform = 0.7});
  EXPECT_GE(outcome_of({.guided_to_uniform = 0.7, .each = 40}).full, 0.88);
  EXPECT_GE(outcome_of({.guided_to_uniform = 0.7, .each = 200}).full, 0.98) << "and keeps it";
}

TEST(AdviceConvergence, HarmfulGuidanceLosesItsShareAfterSixtyOfEach) {
  EXPECT_GE(outcome_of({.guided_to_uniform = 1.5, .each = 60}).at_most_tenth, 0.95);
  EXPECT_GE(outcome_of({.guided_to_uniform = 1.5, .each = 60, .dearer = 4}).at_most_tenth, 0.95);
}

TEST(AdviceConvergence, ATaskThatGetsDearerForBothModesChangesNothing) {
  expect_trusted({.guided_to_uniform = 0.7, .dearer = 4});
  expect_trusted({.guided_to_uniform = 0.7, .dearer = 0.25});
}

TEST(AdviceConvergence, OneAbsurdReportChangesNothing) {
  expect_trusted({.guided_to_uniform = 0.7, .absurd = 9'000'000'000'000'000'000});
}

TEST(AdviceConvergence, SoItIsWithManyUnsolved) {
  expect_trusted({.guided_to_uniform = 0.7, .cap = 4000});
  EXPECT_GE(outcome_of({.guided_to_uniform = 1.5, .each = 60, .cap = 4000}).at_most_tenth, 0.9);
}

/// Guidance that makes no difference: which mode has the share is a matter of chance, but not of
/// every attempt anew.
TEST(AdviceConvergence, WhatMakesNoDifferenceDoesNotSwing) {
  constexpr int kAttempts = 400;
  double moved = 0, swings = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    std::mt19937_64 generator(seed);
    std::bernoulli_distribution coin(0.5);
    evidence::AttemptWindow window;
    double before = -1;
    int side = 0;
    for (int i = 0; i < kAttempts; ++i) {
      const bool guided = coin(generator);
      window.add(guided ? SamplingMode::Guided : SamplingMode::Control, true,
                 static_cast<std::uint64_t>(draw(guided, {}, generator)));
      if (i < kAttempts / 2)
        continue;
      const double share = share_of(window);
      moved += before < 0 ? 0 : std::abs(share - before);
      before = share;
      const int now = share > 0.8 ? 1 : share < 0.1 ? -1 : side;
      swings += side != 0 && now != side ? 1 : 0;
      side = now;
    }
  }
  constexpr double kRuns = 50;
  constexpr double kMovesOfDraw = kAttempts / 2.0, kHundredsOfDraw = kAttempts / 200.0;
  std::printf("share moves by %.4f an attempt, swings %.2f times in 100\n",
              moved / kRuns / kMovesOfDraw, swings / kDraws / kHundredsOfDraw);
  EXPECT_LT(moved / kRuns / kMovesOfDraw, 0.05);
  EXPECT_LT(swings / kRuns / kHundredsOfDraw, 2);
}

}  // namespace
}  // namespace kinship::catalog::advice_convergence_test
