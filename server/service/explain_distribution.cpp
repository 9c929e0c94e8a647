#include "server/service/explain_distribution.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/catalog/freshness.hpp"

namespace kinship::service {
namespace {

/// The part of a task's experience that a distribution is made of.
std::vector<store::ExperienceSummary> selected(const Distribution& distribution,
                                               std::vector<store::ExperienceSummary> experience) {
  const std::vector<Digest>& sources = distribution.selection.sources;
  std::erase_if(experience, [&](const store::ExperienceSummary& source) {
    const bool is_selected =
        sources.empty() || std::find(sources.begin(), sources.end(), source.robot) != sources.end();
    return !is_selected || (source.paths == 0 && source.robot != distribution.robot);
  });
  return experience;
}

std::string label_of(const store::Store& store, const Digest& robot) {
  try {
    if (const auto record = store.find_robot(robot))
      return record->description.label;
  } catch (const Failure&) {  // its row is damaged: the digest has to do
  }
  return robot.short_hex();
}

std::string describe_paths(const Distribution& distribution,
                           const std::vector<store::ExperienceSummary>& experience) {
  std::uint64_t then = 0, now = 0;
  for (const Source& source : distribution.sources)
    then += source.paths;
  for (const store::ExperienceSummary& source : experience)
    now += source.paths;
  return std::to_string(then) + " paths then, " + std::to_string(now) + " now";
}

std::string next_fit(const Distribution& distribution, const Explanation& explanation,
                     bool is_retired, const std::vector<store::ExperienceSummary>& experience,
                     std::int64_t now_ms) {
  const std::string paths = " (" + describe_paths(distribution, experience) + ")";
  if (is_retired)
    return std::string("at the next fetch: ") + kNotServed;
  if (!explanation.behind)
    return has_mixture(distribution.state)
               ? "when the paths have grown by 5, or by 5 % if that is more" + paths
               : "when the experience has changed" + paths;
  if (catalog::may_refit(distribution, now_ms))
    return "at the next fetch, or soon if it is followed" + paths;
  const std::int64_t wait_ms = distribution.fitted_ms + catalog::kRefitInterval.count() - now_ms;
  return "in " + std::to_string((wait_ms + 999) / 1000) +
         " s at the earliest, then at the next fetch" + ", or by itself if it is followed" + paths;
}

}  // namespace

void complete_summaries(const store::Store& store,
                        std::vector<DistributionSummary>& distributions) {
  std::map<std::string, std::vector<store::ExperienceSummary>> experience;  // by task
  for (DistributionSummary& summary : distributions) {
    const std::optional<Distribution> distribution = store.find_distribution(summary.id);
    if (!distribution)
      continue;  // damaged, or evicted meanwhile
    summary.T_task_base = distribution->T_task_base;
    summary.selection = distribution->selection;
    const auto [known, is_new] = experience.try_emplace(summary.task);
    if (is_new)
      known->second = store.experience(summary.task);
    summary.retired = catalog::is_retired(*distribution, known->second);
  }
}

Explanation explain_distribution(const store::Store& store, Distribution distribution,
                                 std::int64_t now_ms) {
  const std::vector<store::ExperienceSummary> all = store.experience(distribution.task);
  const std::vector<store::ExperienceSummary> experience = selected(distribution, all);
  Explanation explanation;
  for (const store::ExperienceSummary& source : experience)
    explanation.experience.push_back(
        {source.robot, label_of(store, source.robot), source.paths, source.generation});
  const bool is_gone = catalog::is_retired(distribution, all);
  explanation.behind = is_gone || catalog::is_behind(distribution, experience);
  explanation.next_fit = next_fit(distribution, explanation, is_gone, experience, now_ms);
  distribution.mixture.reset();
  explanation.distribution = std::move(distribution);
  return explanation;
}

}  // namespace kinship::service
