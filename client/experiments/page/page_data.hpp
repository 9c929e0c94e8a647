#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/experiments/page/demonstration.hpp"
#include "client/experiments/page/grown_search.hpp"
#include "client/experiments/page/run_files.hpp"
#include "client/page/bones.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/scene.hpp"

namespace kinship::experiments {

/// What the distribution says, in the scene that the page shows.
struct DrawnSamples {
  Poses hand;                                     ///< of all samples
  double free_share = 0;                          ///< of those that were asked about, 0 to 1
  double uniform_free_share = 0;                  ///< of as many uniform ones
  std::vector<std::vector<page::Bone>> postures;  ///< some that are free, far from each other
};

/// The same instance planned with both samplings.
struct SearchPair {
  GrownSearch uniform, guided;
};

/// Everything a page shows.
struct PageData {
  std::vector<FleetMember> fleet;  ///< may be empty
  std::string robot;               ///< label of the new robot
  std::vector<std::string> held;   ///< names of what it holds
  Distribution distribution;
  std::optional<Advice> advice;  ///< what the server makes of the new robot's attempts
  /// Members of the page's data that are statistics (analysis/page_figures.py). "typical" is null
  /// where no instance was solved by both: the first problem is shown.
  nlohmann::ordered_json figures;
  std::vector<SceneObject> obstacles;     ///< of the instance that is shown
  std::optional<Demonstration> newcomer;  ///< its guided path
  std::optional<SearchPair> searches;     ///< if they were recorded
  DrawnSamples samples;
};

/// Reads the run and draws the samples (seeded: equal files, equal page).
/// \throws Failure that names the file if one is missing or broken, or does not belong to the
/// others.
PageData read_run(const RunFiles& run);

}  // namespace kinship::experiments
