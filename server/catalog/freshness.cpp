#include "server/catalog/freshness.hpp"

#include <algorithm>

#include "server/fitting/selected_experience.hpp"

namespace kinship::catalog {
namespace {

constexpr std::uint64_t kGrowthPaths = 5;
constexpr std::uint64_t kGrowthDivisor = 20;  // 5 %

/// Paths that replaced others, at least: each generation since brought one, and the growth in
/// number replaced none.
std::uint64_t replaced_paths(const Source& then, const store::ExperienceSummary& now) {
  if (now.dropped == 0 || now.generation <= then.generation)
    return 0;
  const std::uint64_t brought = now.generation - then.generation;
  const std::uint64_t more = now.paths > then.paths ? now.paths - then.paths : 0;
  return brought > more ? brought - more : 0;
}

/// Paths of a source to compare new ones with: where a lowered cap has dropped most of them the
/// remaining ones, or no growth would ever count again.
std::uint64_t paths_to_outgrow(const Source& then,
                               const std::vector<store::ExperienceSummary>& experience) {
  for (const store::ExperienceSummary& now : experience)
    if (now.robot == then.robot && now.dropped > 0)
      return std::min(then.paths, now.paths);
  return then.paths;
}

}  // namespace

bool has_grown(const Distribution& distribution,
               const std::vector<store::ExperienceSummary>& experience) {
  std::uint64_t then = 0, used = 0;
  for (const Source& source : distribution.sources) {
    then += paths_to_outgrow(source, experience);
    used += source.paths_used;
  }
  std::uint64_t now = fitting::count_paths(experience);
  for (const Source& source : distribution.sources)
    for (const store::ExperienceSummary& other : experience)
      if (other.robot == source.robot)
        now += replaced_paths(source, other);
  const std::uint64_t base = distribution.selection.since_ms > 0 ? used : then;
  return now >= then + std::max(kGrowthPaths, base / kGrowthDivisor);
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
        return now == experience.end() || then.generation < now->retired_generation ||
               then.generation > now->generation;
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
