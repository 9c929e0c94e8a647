#include "client/experiments/analysis/cell_statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "client/experiments/statistics.hpp"

namespace kinship::experiments {
namespace {

constexpr std::size_t kResamples = 10'000;
constexpr double kTail = 0.025;

using Instances = std::vector<std::size_t>;

std::vector<double> sums_of(const std::vector<std::vector<double>>& by_instance) {
  std::vector<double> sums;
  for (const std::vector<double>& values : by_instance) {
    double sum = 0;
    for (const double value : values)
      sum += value;
    sums.push_back(sum);
  }
  return sums;
}

/// Sums over instances of what a pair compares.
struct PairSums {
  std::vector<double> uniform, guided;
};

double ratio_over(const PairSums& sums, const Instances& instances) {
  double uniform = 0, guided = 0;
  for (const std::size_t i : instances) {
    uniform += sums.uniform[i];
    guided += sums.guided[i];
  }
  return uniform / guided;
}

double geometric_mean_over(const std::vector<PairSums>& pairs, const Instances& instances) {
  double logarithms = 0;
  for (const PairSums& sums : pairs)
    logarithms += std::log(ratio_over(sums, instances));
  return std::exp(logarithms / static_cast<double>(pairs.size()));
}

/// The value over all instances, and over resamples of them.
/// Source: Efron and Tibshirani, An Introduction to the Bootstrap (1993), section 13.3.
GeometricMean bootstrap(const std::vector<PairSums>& pairs) {
  const std::size_t count = pairs.front().uniform.size();
  Instances instances(count);
  for (std::size_t i = 0; i < count; ++i)
    instances[i] = i;
  GeometricMean result;
  result.pairs = pairs.size();
  result.value = geometric_mean_over(pairs, instances);
  std::mt19937_64 generator(1);
  std::uniform_int_distribution<std::size_t> any(0, count - 1);
  std::vector<double> values(kResamples);
  for (double& value : values) {
    for (std::size_t& i : instances)
      i = any(generator);
    value = geometric_mean_over(pairs, instances);
  }
  std::ranges::sort(values);
  const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(kResamples));
  result.low = values[tail];
  result.high = values[kResamples - 1 - tail];
  return result;
}

void count_discordant(const CellResults& uniform, const CellResults& guided, PairRatio& pair) {
  for (std::size_t i = 0; i < uniform.solved.size(); ++i)
    for (std::size_t seed = 0; seed < uniform.solved[i].size(); ++seed) {
      const bool without = uniform.solved[i][seed], with = guided.solved[i][seed];
      pair.guided_only += with && !without ? 1 : 0;
      pair.uniform_only += without && !with ? 1 : 0;
    }
}

bool have_equal_queries(const CellResults& a, const CellResults& b) {
  const auto same_seeds = [](const auto& first, const auto& second) {
    return first.size() == second.size();
  };
  return !a.instances.empty() && a.instances == b.instances &&
         std::ranges::equal(a.checks, b.checks, same_seeds);
}

}  // namespace

Moments moments_of(const std::vector<double>& values) {
  Moments moments;
  moments.mean = mean(values);
  moments.median = median(values);
  double squares = 0;
  for (const double value : values)
    squares += (value - moments.mean) * (value - moments.mean);
  if (values.size() > 1)
    moments.deviation = std::sqrt(squares / static_cast<double>(values.size() - 1));
  return moments;
}

std::size_t CellResults::queries() const {
  std::size_t count = 0;
  for (const auto& seeds : solved)
    count += seeds.size();
  return count;
}

std::size_t CellResults::solved_queries() const {
  std::size_t count = 0;
  for (const auto& seeds : solved)
    count += static_cast<std::size_t>(std::ranges::count(seeds, true));
  return count;
}

CellResults collect_cell(const std::vector<QueryResult>& results, const std::string& robot,
                         const std::string& guidance, std::uint64_t max_checks) {
  std::vector<const QueryResult*> mine;
  for (const QueryResult& result : results)
    if (result.key.robot == robot && result.key.guidance == guidance)
      mine.push_back(&result);
  std::ranges::sort(mine, {}, [](const QueryResult* result) { return result->key; });

  CellResults cell;
  cell.robot = robot;
  cell.guidance = guidance;
  double checks = 0, projections = 0;
  for (const QueryResult* const result : mine) {
    if (cell.instances.empty() || cell.instances.back() != result->key.instance) {
      cell.instances.push_back(result->key.instance);
      cell.checks.emplace_back();
      cell.cpu_s.emplace_back();
      cell.solved.emplace_back();
      cell.lengths.emplace_back();
    }
    const std::uint64_t counted = result->solved ? result->checks : max_checks;
    cell.checks.back().push_back(static_cast<double>(counted));
    cell.cpu_s.back().push_back(result->cpu_s);
    cell.solved.back().push_back(result->solved);
    if (result->solved)
      cell.lengths.back().push_back(result->length);
    checks += static_cast<double>(result->checks);
    projections += static_cast<double>(result->projections);
  }
  cell.projections_per_check = checks > 0 ? projections / checks : 0;
  return cell;
}

std::vector<double> flat(const std::vector<std::vector<double>>& by_instance) {
  std::vector<double> values;
  for (const auto& each : by_instance)
    values.insert(values.end(), each.begin(), each.end());
  return values;
}

std::vector<double> instance_means(const std::vector<std::vector<double>>& by_instance) {
  std::vector<double> means;
  for (const auto& values : by_instance)
    means.push_back(mean(values));
  return means;
}

PairRatio compare_cells(const CellResults& uniform, const CellResults& guided) {
  if (!have_equal_queries(uniform, guided))
    throw std::invalid_argument("compare_cells: " + guided.robot + " guided by '" +
                                guided.guidance + "' and '" + uniform.guidance +
                                "' have different queries");
  PairRatio pair;
  pair.robot = guided.robot;
  pair.guidance = guided.guidance;
  const GeometricMean checks = geometric_mean_ratio({{&uniform, &guided}}, Quantity::Checks);
  pair.checks_ratio = checks.value;
  pair.low = checks.low;
  pair.high = checks.high;
  pair.median_checks_ratio = median(flat(uniform.checks)) / median(flat(guided.checks));
  pair.cpu_ratio = mean(flat(uniform.cpu_s)) / mean(flat(guided.cpu_s));
  pair.checks_test =
      wilcoxon_signed_rank(instance_means(uniform.checks), instance_means(guided.checks));
  pair.cpu_test = wilcoxon_signed_rank(instance_means(uniform.cpu_s), instance_means(guided.cpu_s));
  count_discordant(uniform, guided, pair);
  pair.success_p = mcnemar_p(pair.guided_only, pair.uniform_only);
  return pair;
}

GeometricMean geometric_mean_ratio(
    const std::vector<std::pair<const CellResults*, const CellResults*>>& pairs,
    Quantity quantity) {
  if (pairs.empty())
    return {};
  std::vector<PairSums> sums;
  for (const auto& [uniform, guided] : pairs) {
    const bool is_checks = quantity == Quantity::Checks;
    sums.push_back({sums_of(is_checks ? uniform->checks : uniform->cpu_s),
                    sums_of(is_checks ? guided->checks : guided->cpu_s)});
    const std::size_t count = sums.front().uniform.size();
    if (sums.back().uniform.size() != count || sums.back().guided.size() != count || count == 0)
      throw std::invalid_argument("geometric_mean_ratio: pairs differ in their instances");
  }
  return bootstrap(sums);
}

double mcnemar_p(std::size_t first_only, std::size_t second_only) {
  const auto trials = static_cast<double>(first_only + second_only);
  const auto fewer = std::min(first_only, second_only);
  double tail = 0;
  for (std::size_t k = 0; k <= fewer; ++k) {
    const auto successes = static_cast<double>(k);
    tail += std::exp(std::lgamma(trials + 1) - std::lgamma(successes + 1) -
                     std::lgamma(trials - successes + 1) - trials * std::log(2.0));
  }
  return std::min(1.0, 2 * tail);
}

}  // namespace kinship::experiments
