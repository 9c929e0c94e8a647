#include "client/experiments/wilcoxon.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace kinship::experiments {
namespace {

/// Differences other than zero; infinite ones keep their sign.
std::vector<double> differences(const std::vector<double>& first,
                                const std::vector<double>& second) {
  std::vector<double> result;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (std::isnan(first[i]) || std::isnan(second[i]))
      throw std::invalid_argument("wilcoxon: a value is not a number");
    if (first[i] != second[i])
      result.push_back(first[i] - second[i]);  // inf - inf cannot occur
  }
  return result;
}

/// Twice the rank of each magnitude, 1 for the smallest, shared ranks averaged: whole numbers.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto magnitude = [&](std::size_t i) { return std::abs(values[i]); };
  std::ranges::sort(order, {}, magnitude);
  std::vector<std::size_t> ranks(values.size());
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && magnitude(order[end]) == magnitude(order[begin]))
      ++end;
    for (std::size_t i = begin; i < end; ++i)
      ranks[order[i]] = begin + 1 + end;
    begin = end;
  }
  return ranks;
}

/// P(doubled rank sum <= bound) when every sign is a fair coin, by adding one rank at a time.
double probability_up_to(const std::vector<std::size_t>& ranks, std::size_t bound) {
  const std::size_t total = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<double> probability(total + 1, 0.0);
  probability[0] = 1;
  std::size_t reached = 0;
  for (const std::size_t rank : ranks) {
    reached += rank;
    for (std::size_t sum = reached + 1; sum-- > 0;)
      probability[sum] = (probability[sum] + (sum >= rank ? probability[sum - rank] : 0)) / 2;
  }
  const auto end = probability.begin() + static_cast<std::ptrdiff_t>(bound) + 1;
  return std::accumulate(probability.begin(), end, 0.0);
}

/// Two-sided p of the smaller rank sum. The variance is the sum of squared ranks over 4, which
/// holds the correction for ties: n (n + 1) (2 n + 1) / 24 - sum(t^3 - t) / 48.
double approximate_p(const std::vector<std::size_t>& ranks, double smaller_sum) {
  double rank_sum = 0;
  double squares = 0;
  for (const std::size_t doubled : ranks) {
    const double rank = static_cast<double>(doubled) / 2;
    rank_sum += rank;
    squares += rank * rank;
  }
  constexpr double kContinuity = 0.5;
  const double distance = std::max(0.0, rank_sum / 2 - smaller_sum - kContinuity);
  return std::erfc(distance / std::sqrt(squares / 4) / std::sqrt(2.0));
}

}  // namespace

WilcoxonSummary wilcoxon_signed_rank(const std::vector<double>& first,
                                     const std::vector<double>& second) {
  if (first.size() != second.size())
    throw std::invalid_argument("wilcoxon: " + std::to_string(first.size()) + " first and " +
                                std::to_string(second.size()) + " second values");
  const std::vector<double> values = differences(first, second);
  WilcoxonSummary summary;
  summary.pairs = values.size();
  summary.dropped = first.size() - values.size();
  if (values.empty())
    return summary;

  const std::vector<std::size_t> ranks = doubled_ranks(values);
  std::size_t plus = 0;
  std::size_t minus = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    (values[i] > 0 ? plus : minus) += ranks[i];
  summary.rank_sum_plus = static_cast<double>(plus) / 2;
  summary.rank_sum_minus = static_cast<double>(minus) / 2;
  const std::size_t smaller = std::min(plus, minus);
  if (values.size() <= kMaxExactPairs) {
    summary.p = std::min(1.0, 2 * probability_up_to(ranks, smaller));
  } else {
    summary.method = WilcoxonMethod::NormalApproximation;
    summary.p = approximate_p(ranks, static_cast<double>(smaller) / 2);
  }
  return summary;
}

}  // namespace kinship::experiments
