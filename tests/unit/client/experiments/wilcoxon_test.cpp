#include "client/experiments/wilcoxon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace kinship::experiments::wilcoxon_test {
namespace {

constexpr std::uint64_t kSeed = 41;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

WilcoxonSummary test_of_differences(const std::vector<double>& differences) {
  return wilcoxon_signed_rank(differences, std::vector<double>(differences.size(), 0.0));
}

std::vector<double> mean_ranks(const std::vector<double>& values) {
  std::vector<double> ranks;
  for (const double value : values) {
    double rank = 0.5;
    for (const double other : values) {
      if (std::abs(other) < std::abs(value))
        rank += 1;
      if (std::abs(other) == std::abs(value))
        rank += 0.5;
    }
    ranks.push_back(rank);
  }
  return ranks;
}

/// Counts over all 2^n signs how often the rank sum is at least as far from its mean.
double p_by_enumeration(const std::vector<double>& differences) {
  const std::vector<double> ranks = mean_ranks(differences);
  const std::size_t n = ranks.size();
  double total = 0;
  double observed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    total += ranks[i];
    if (differences[i] > 0)
      observed += ranks[i];
  }
  std::size_t as_far = 0;
  for (std::size_t signs = 0; signs < (std::size_t{1} << n); ++signs) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i)
      if ((signs >> i) & 1U)
        sum += ranks[i];
    if (std::abs(sum - total / 2) >= std::abs(observed - total / 2) - 1e-9)
      ++as_far;
  }
  return static_cast<double>(as_far) / static_cast<double>(std::size_t{1} << n);
}

TEST(Wilcoxon, GivesThePublishedValueForTheDepressionScale) {
  // Hollander and Wolfe, Nonparametric Statistical Methods, table 3.1: T+ = 40, one-sided 0.0195.
  const auto summary =
      wilcoxon_signed_rank({1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30},
                           {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29});
  EXPECT_EQ(summary.rank_sum_plus, 40);
  EXPECT_EQ(summary.rank_sum_minus, 5);
  EXPECT_EQ(summary.p, 0.0390625);
}

TEST(Wilcoxon, GivesThePublishedValueForDarwinsMaize) {
  // Fisher, The Design of Experiments, section 17; W = 24, p = 0.041259765625.
  const auto summary =
      test_of_differences({6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75});
  EXPECT_EQ(summary.rank_sum_minus, 24);
  EXPECT_NEAR(summary.p, 0.041259765625, 1e-15);
  EXPECT_EQ(summary.method, WilcoxonMethod::Exact);
}

TEST(Wilcoxon, EqualsEnumerationOfAllSignsAlsoWithSharedRanks) {
  std::mt19937_64 generator(kSeed);
  std::uniform_int_distribution<int> magnitude(1, 6);  // few values: many shared ranks
  for (int n = 1; n <= 12; ++n) {
    std::vector<double> differences;
    for (int i = 0; i < n; ++i)
      differences.push_back((generator() % 3 == 0 ? -1 : 1) * magnitude(generator));
    EXPECT_NEAR(test_of_differences(differences).p, std::min(1.0, p_by_enumeration(differences)),
                1e-12)
        << "n = " << n;
  }
}

TEST(Wilcoxon, NormalApproximationMeetsTheExactValueAtTheBorder) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> shifted(0.12, 1);
  std::vector<double> differences;
  while (differences.size() < kMaxExactPairs)
    differences.push_back(shifted(generator));
  const auto exact = test_of_differences(differences);
  differences.push_back(1e-9);  // the smallest rank hardly matters
  const auto approximate = test_of_differences(differences);
  EXPECT_EQ(exact.method, WilcoxonMethod::Exact);
  EXPECT_EQ(approximate.method, WilcoxonMethod::NormalApproximation);
  EXPECT_NEAR(approximate.p, exact.p, 0.01 * exact.p + 1e-4);
}

TEST(Wilcoxon, NormalApproximationCorrectsForTies) {
  // 300 differences of equal size, 180 positive: every rank is 150.5, a sign test.
  std::vector<double> differences(180, 1.0);
  differences.resize(300, -1.0);
  const double mean = 300 * 150.5 / 2;
  const double deviation = std::sqrt(300 * 150.5 * 150.5 / 4);
  const double z = (mean - 120 * 150.5 - 0.5) / deviation;
  EXPECT_NEAR(test_of_differences(differences).p, std::erfc(z / std::sqrt(2.0)), 1e-12);
}

TEST(Wilcoxon, UnsolvedIsWorseThanAnySolvedAndEqualToUnsolved) {
  const auto summary =
      wilcoxon_signed_rank({kInfinity, 5, kInfinity, 900}, {100, kInfinity, kInfinity, 100});
  EXPECT_EQ(summary.dropped, 1U);
  EXPECT_EQ(summary.pairs, 3U);
  EXPECT_EQ(summary.rank_sum_plus, 1 + 2.5);  // 800 has rank 1, the two infinite ones share 2 and 3
  EXPECT_EQ(summary.rank_sum_minus, 2.5);
}

TEST(Wilcoxon, DoesNotDependOnWhichSideIsFirst) {
  const std::vector<double> a = {3, 8, 1, 9, kInfinity, 4};
  const std::vector<double> b = {2, 5, 6, 1, 7, 4};
  EXPECT_EQ(wilcoxon_signed_rank(a, b).p, wilcoxon_signed_rank(b, a).p);
  EXPECT_EQ(wilcoxon_signed_rank(a, b).rank_sum_plus, wilcoxon_signed_rank(b, a).rank_sum_minus);
}

TEST(Wilcoxon, NoDifferenceIsNoEvidence) {
  EXPECT_EQ(wilcoxon_signed_rank({1, kInfinity}, {1, kInfinity}).p, 1);
  EXPECT_EQ(wilcoxon_signed_rank({}, {}).p, 1);
  EXPECT_EQ(test_of_differences({7}).p, 1);
}

TEST(Wilcoxon, RefusesWhatCannotBeRanked) {
  EXPECT_THROW(wilcoxon_signed_rank({1, 2}, {1}), std::invalid_argument);
  EXPECT_THROW(wilcoxon_signed_rank({std::nan("")}, {1}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::experiments::wilcoxon_test
