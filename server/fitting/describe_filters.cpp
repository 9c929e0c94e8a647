#include "server/fitting/describe_filters.hpp"

#include <cstdint>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::fitting {
namespace {

struct FilteredCounts {
  std::uint64_t checks = 0, self_collisions = 0, scene_collisions = 0;
  std::uint64_t paths = 0, with_scene = 0, with_approximate_scene = 0, blocked = 0;
};

FilteredCounts count_filtered(const std::vector<SourceSummary>& sources) {
  FilteredCounts counts;
  for (const SourceSummary& summary : sources) {
    counts.checks += summary.source.filter_checks;
    counts.self_collisions += summary.source.self_collisions;
    counts.scene_collisions += summary.source.scene_collisions;
    counts.paths += summary.source.paths_used;
    counts.with_scene += summary.source.paths_with_scene;
    counts.with_approximate_scene += summary.paths_with_approximate_scene;
    counts.blocked += summary.paths_blocked;
  }
  return counts;
}

std::string of(std::uint64_t part, std::uint64_t whole) {
  return std::to_string(part) + " of " + std::to_string(whole);
}

/// Why a robot without shapes is not filtered, and the remedy.
std::string without_shapes(const runtime::Robot& target) {
  std::string words = "not filtered, for '" + target.label + "': " + target.geometry;
  if (target.grade == GeometryGrade::None)
    words += "; register it again where its meshes are (kinship robots register)";
  return words;
}

std::string describe_self(const runtime::Robot& target, const FilteredCounts& counts) {
  if (target.shapes.shapes.empty())
    return without_shapes(target);
  if (counts.checks == 0)
    return target.geometry + "; nothing was asked, as waypoints were taken over";
  return target.geometry + "; left out " + of(counts.self_collisions, counts.checks) +
         " configurations";
}

std::string describe_scenes(const runtime::Robot& target, const FilteredCounts& counts) {
  if (target.shapes.shapes.empty())
    return "not filtered, as the robot has no shapes here";
  if (counts.with_scene == 0)
    return "not filtered, as no path that was transferred came with one";
  std::string words = "those of " + of(counts.with_scene, counts.paths) + " paths";
  if (counts.with_approximate_scene > 0)
    words += ", " + std::to_string(counts.with_approximate_scene) +
             " of them with solids around meshes (approximate)";
  words += "; left out " + of(counts.scene_collisions, counts.checks) + " configurations";
  if (counts.blocked > 0)
    words += ", all of " + std::to_string(counts.blocked) + " paths";
  return words;
}

}  // namespace

std::string describe_filters(const TransferParameters& wanted, const runtime::Robot& target,
                             const std::vector<SourceSummary>& sources) {
  const FilteredCounts counts = count_filtered(sources);
  const std::string unwanted = "not filtered, as the profile says";
  return cut_text("self-collision: " +
                      (wanted.avoid_self_collision ? describe_self(target, counts) : unwanted) +
                      ". recorded scenes: " +
                      (wanted.avoid_recorded_scene ? describe_scenes(target, counts) : unwanted),
                  kMaxMessageBytes);
}

}  // namespace kinship::fitting
