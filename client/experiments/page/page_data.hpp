#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/experiments/comparison.hpp"
#include "client/experiments/page/demonstration.hpp"
#include "client/experiments/page/run_files.hpp"
#include "client/experiments/page/typical_instance.hpp"
#include "client/experiments/statistics.hpp"
#include "client/page/bones.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/rehearsal.hpp"
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
  Comparison comparison;
  std::vector<AlsoCompared> also;              ///< may be empty
  MeanInterval uniform_checks, guided_checks;  ///< means with 95 % intervals
  MeanInterval uniform_time_s, guided_time_s;
  std::map<Guide, std::size_t> guides;  ///< of the guided attempts, how many had each
  std::size_t cheaper_guided = 0;       ///< instances that took fewer checks with guidance
  /// The instance that is shown: a typical one, or the first problem where none was solved by both.
  std::optional<TypicalInstance> typical;
  std::vector<SceneObject> obstacles;     ///< of it
  std::optional<Demonstration> newcomer;  ///< its guided path
  std::optional<SearchPair> searches;     ///< if they were recorded
  DrawnSamples samples;
};

/// Reads the run and draws the samples (seeded: equal files, equal page).
/// \throws Failure that names the file if one is missing or broken, or does not belong to the
/// others.
PageData read_run(const RunFiles& run);

}  // namespace kinship::experiments
