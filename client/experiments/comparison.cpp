#include "client/experiments/comparison.hpp"

#include <limits>
#include <map>

#include "client/experiments/statistics.hpp"

namespace kinship::experiments {
namespace {

using ResultsByName = std::map<std::string, const ProblemResult*>;

/// One planner's figures in the order of the pairs: as used, and with unsolved as infinite.
struct Figures {
  std::vector<double> checks, time_s;
  std::vector<double> ranked_checks, ranked_time_s;
  PlannerStatistics statistics;

  void add(const ProblemResult& result) {
    constexpr double kWorst = std::numeric_limits<double>::infinity();
    checks.push_back(static_cast<double>(result.collision_checks));
    time_s.push_back(result.planning_time_s);
    ranked_checks.push_back(result.solved ? checks.back() : kWorst);
    ranked_time_s.push_back(result.solved ? time_s.back() : kWorst);
    if (result.solved)
      ++statistics.solved;
    if (result.distribution_id && result.share > 0)
      ++statistics.with_guidance;
  }

  void summarize() {
    statistics.mean_checks = mean(checks);
    statistics.median_checks = median(ranked_checks);
    statistics.mean_time_s = mean(time_s);
    statistics.median_time_s = median(ranked_time_s);
  }
};

Result<ResultsByName> by_name(const std::vector<ProblemResult>& results, const std::string& side) {
  ResultsByName named;
  for (const ProblemResult& result : results)
    if (!named.emplace(result.name, &result).second)
      return Error{ErrorCode::InvalidInput,
                   side + " results: '" + result.name + "' occurs more than once"};
  return named;
}

}  // namespace

Result<Comparison> compare(const std::vector<ProblemResult>& uniform,
                           const std::vector<ProblemResult>& guided) {
  const Result<ResultsByName> uniform_by_name = by_name(uniform, "uniform");
  if (!uniform_by_name)
    return uniform_by_name.error();
  const Result<ResultsByName> guided_by_name = by_name(guided, "guided");
  if (!guided_by_name)
    return guided_by_name.error();

  Comparison comparison;
  Figures uniform_figures;
  Figures guided_figures;
  for (const auto& [name, result] : *uniform_by_name) {
    const auto other = guided_by_name->find(name);
    if (other == guided_by_name->end()) {
      comparison.unpaired.push_back(name);
      continue;
    }
    if (result->not_planned || other->second->not_planned) {
      comparison.unplanned.add(result->not_planned ? *result : *other->second);
      continue;
    }
    uniform_figures.add(*result);
    guided_figures.add(*other->second);
    const bool both_solved = result->solved && other->second->solved;
    if (both_solved && result->proven != other->second->proven)
      ++comparison.proven_by_one;
    ++comparison.pairs;
  }
  for (const auto& [name, result] : *guided_by_name)
    if (!uniform_by_name->contains(name))
      comparison.unpaired.push_back(name);
  if (comparison.pairs == 0)
    return Error{ErrorCode::InvalidInput,
                 comparison.unplanned.size() == 0
                     ? "no problem was answered by both sides"
                     : "no problem could be planned (" + comparison.unplanned.reasons() + ")"};

  uniform_figures.summarize();
  guided_figures.summarize();
  const PlannerStatistics& u = comparison.uniform = uniform_figures.statistics;
  const PlannerStatistics& g = comparison.guided = guided_figures.statistics;
  comparison.mean_checks_ratio = u.mean_checks / g.mean_checks;
  comparison.median_checks_ratio = u.median_checks / g.median_checks;
  comparison.mean_time_ratio = u.mean_time_s / g.mean_time_s;
  comparison.median_time_ratio = u.median_time_s / g.median_time_s;
  comparison.checks_test =
      wilcoxon_signed_rank(uniform_figures.ranked_checks, guided_figures.ranked_checks);
  comparison.time_test =
      wilcoxon_signed_rank(uniform_figures.ranked_time_s, guided_figures.ranked_time_s);
  return comparison;
}

}  // namespace kinship::experiments
