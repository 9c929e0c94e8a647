#include "server/fitting/warm_refit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/density/hold_out.hpp"
#include "server/fitting/branch_cuts.hpp"

namespace kinship::fitting {
namespace {

/// Paths of the fit before that are not there any more, or became something else: their recorded
/// scene is readable again.
std::uint64_t count_lost(const KnownPaths& before, const KnownPaths& now) {
  std::uint64_t lost = 0;
  for (const auto& [id, then] : before) {
    const auto found = now.find(id);
    const bool holds = found != now.end() && found->second.report == then.report &&
                       (found->second.path == then.path ||
                        found->second.path->configurations == then.path->configurations);
    lost += holds ? 0 : 1;
  }
  return lost;
}

double largest_move(const std::vector<double>& before, const std::vector<double>& now) {
  double move = 0;
  for (std::size_t i = 0; i < now.size(); ++i)
    move = std::max(move, std::abs(now[i] - before[i]));
  return move;
}

/// Whether components can be chosen by hold-out now, which could not be done before.
bool can_choose(const Refit& refit, const FullFit& full) {
  return refit.key.profile.density.components == 0 && full.component_scores.empty() &&
         refit.paths.size() >= density::kMinPathsToScore;
}

}  // namespace

std::vector<Digest> used_sources(const std::vector<SourceSummary>& sources) {
  std::vector<Digest> used;
  for (const SourceSummary& summary : sources)
    if (summary.source.paths_used > 0)
      used.push_back(summary.source.robot);
  return used;
}

std::vector<double> used_masses(const std::vector<SourceSummary>& sources,
                                const std::vector<double>& masses) {
  std::vector<double> used;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (sources[i].source.paths_used > 0)
      used.push_back(masses[i]);
  return used;
}

std::string why_full(const Refit& refit, const WarmState* before) {
  if (!refit.key.profile.density.warm_refits)
    return "the profile asks for it";
  if (before == nullptr || !before->mixture)
    return "no earlier one in memory";
  if (refit.key.profile.density.estimator == Estimator::Kernels)
    return "kernels are always made anew";  // they share one covariance: nothing to start EM from
  const std::string since = " since revision ";
  if (const std::uint64_t lost = count_lost(before->paths, refit.paths); lost > 0)
    return std::to_string(lost) + " paths of revision " + std::to_string(before->revision) +
           " left out or changed";
  if (used_sources(refit.sources) != before->sources)
    return "other source robots than in revision " + std::to_string(before->revision);
  const FullFit& full = before->full;
  if (refit.paths.size() >= kFullFitGrowth * full.paths)
    return "paths have doubled" + since + std::to_string(full.revision);
  const double move = largest_move(full.masses, used_masses(refit.sources, refit.masses));
  if (move > kMassJump) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", move);
    return "the mass of a source moved by " + std::string(text) + since +
           std::to_string(full.revision);
  }
  if (can_choose(refit, full))
    return "paths suffice to choose components";
  if (!still_cuts(before->cuts, refit.target, refit.configurations))
    return "a continuous joint is cut elsewhere";
  return {};
}

}  // namespace kinship::fitting
