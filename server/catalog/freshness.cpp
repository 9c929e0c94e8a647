#include "server/catalog/freshness.hpp"

#include <algorithm>

#include "server/fitting/selected_experience.hpp"

namespace kinship::catalog {
namespace {

constexpr std::uint64_t kGrowthPaths = 5;
constexpr std::uint64_t kGrowthDivisor = 20;  // 5 %

}  // namespace

bool has_grown(const Distribution& distribution,
               const std::vector<store::ExperienceSummary>& experience) {
  std::uint64_t then = 0, used = 0;
  for (const Source& source : distribution.sources) {
    then += source.paths;
    used += source.paths_used;
  }
  const std::uint64_t base = distribution.selection.since_ms > 0 ? used : then;
  return fitting::count_paths(experience) >= then + std::max(kGrowthPaths, base / kGrowthDivisor);
}

bool has_changed(const Distribution& distribution,
                 const std::vector<store::ExperienceSummary>& experience) {
  if (distribution.sources.size() != experience.size())
    return true;
  return std::any_of(
      experience.begin(), experience.end(), [&distribution](const store::ExperienceSummary& now) {
        return std::none_of(distribution.sources.begin(), distribution.sources.end(),
                            [&now](const Source& then) {
                              return then.robot == now.robot && then.generation == now.generation;
                            });
      });
}

bool is_behind(const Distribution& distribution,
               const std::vector<store::ExperienceSummary>& experience) {
  return has_mixture(distribution.state) ? has_grown(distribution, experience)
                                         : has_changed(distribution, experience);
}

bool is_retired(const Distribution& distribution,
                const std::vector<store::ExperienceSummary>& experience) {
  return std::any_of(
      distribution.sources.begin(), distribution.sources.end(), [&experience](const Source& then) {
        const auto now = std::find_if(
            experience.begin(), experience.end(),
            [&then](const store::ExperienceSummary& other) { return other.robot == then.robot; });
        return now == experience.end() || then.generation < now->retired_generation;
      });
}

bool may_refit(const Distribution& distribution, std::int64_t now_ms) {
  return until_refit(distribution.fitted_ms, now_ms).count() == 0;
}

std::chrono::milliseconds until_refit(std::int64_t fitted_ms, std::int64_t now_ms) {
  const std::chrono::milliseconds age(now_ms - fitted_ms);
  if (age.count() < 0 || age >= kRefitInterval)
    return std::chrono::milliseconds(0);
  return kRefitInterval - age;
}

std::uint64_t generation_of(const Digest& robot,
                            const std::vector<store::ExperienceSummary>& experience) {
  for (const store::ExperienceSummary& source : experience)
    if (source.robot == robot)
      return source.generation;
  return 0;
}

std::uint64_t own_generation(const Distribution& distribution) {
  for (const Source& source : distribution.sources)
    if (source.robot == distribution.robot)
      return source.generation;
  return 0;
}

}  // namespace kinship::catalog
