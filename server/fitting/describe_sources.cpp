#include "server/fitting/describe_sources.hpp"

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::fitting {
namespace {

std::string joined(const std::vector<std::string>& parts) {
  std::string words;
  for (const std::string& part : parts)
    words += (words.empty() ? "" : "; ") + part;
  return words;
}

}  // namespace

std::string describe_sources(const std::vector<SourceSummary>& sources) {
  std::vector<std::string> parts;
  parts.reserve(sources.size());
  for (const SourceSummary& summary : sources) {
    const Source& source = summary.source;
    parts.push_back("'" + source.label + "': " + std::to_string(source.paths_used) + " paths, " +
                    std::to_string(source.poses) + " poses, " +
                    std::to_string(source.poses_solved) + " solved, " +
                    std::to_string(source.out_of_reach) + " out of reach, " +
                    std::to_string(source.outside_limits) + " outside limits, " +
                    std::to_string(source.not_converged) + " not converged, " +
                    std::to_string(source.colliding) + " colliding");
  }
  return joined(parts);
}

std::string describe_warnings(const std::vector<SourceSummary>& sources, bool target_is_placed) {
  std::vector<std::string> found;
  bool placed = target_is_placed, unplaced = !target_is_placed;
  for (const SourceSummary& summary : sources) {
    const std::string name = "'" + summary.source.label + "': ";
    placed = placed || summary.has_placed;
    unplaced = unplaced || summary.has_unplaced;
    if (!summary.problem.empty())
      found.push_back(name +
                      (summary.paths_left_out > 0
                           ? std::to_string(summary.paths_left_out) + " paths left out, first "
                           : "left out, ") +
                      summary.problem);
    if (summary.paths_blocked > 0)
      found.push_back(name + "of " + std::to_string(summary.paths_blocked) + " of " +
                      std::to_string(summary.source.paths_with_scene) +
                      " paths with a recorded scene nothing is free of it");
    if (!summary.scene_problem.empty())
      found.push_back(name + summary.scene_problem);
    const std::uint64_t tried = summary.source.paths_used + summary.paths_left_out;
    if (tried > 0 && tried < summary.paths_selected)
      found.push_back(name + std::to_string(tried) + " of " +
                      std::to_string(summary.paths_selected) + " paths read");
  }
  if (placed && unplaced)
    found.emplace_back("some placements are missing and were taken as the identity");
  return cut_text(joined(found), kMaxMessageBytes);
}

}  // namespace kinship::fitting
