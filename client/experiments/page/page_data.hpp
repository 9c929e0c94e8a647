#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/experiments/comparison.hpp"
#include "client/experiments/statistics.hpp"
#include "client/page/bones.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/scene.hpp"

namespace kinship::experiments {

/// Where the run is that a page tells of: a folder as deploy/quickstart leaves it.
struct RunFolder {
  std::filesystem::path folder;    ///< ROBOT.problems.jsonl, ROBOT.results.jsonl of the fleet;
                                   ///< ROBOT-uniform.results.jsonl, ROBOT-guided.results.jsonl and
                                   ///< distribution.json of the new robot, advice.json, which is
                                   ///< the same fetched after its attempts
  std::filesystem::path models;    ///< folder of model folders
  std::vector<std::string> fleet;  ///< names of the experienced robots' model folders
  std::string robot;               ///< of the new robot's
};

/// Positions of the transfer frame and its approach directions, in the task frame.
struct Poses {
  Eigen::Matrix3Xd positions;   ///< m
  Eigen::Matrix3Xd directions;  ///< unit vectors
};

/// What a robot of the fleet did.
struct FleetMember {
  std::string label;
  std::size_t problems = 0;
  std::vector<Poses> paths;  ///< resampled
};

/// Everything a page shows.
struct PageData {
  std::vector<FleetMember> fleet;
  std::string robot;  ///< label of the new robot
  Scene scene;        ///< one instance of its problems
  Distribution distribution;
  Advice advice;                  ///< what the server makes of the new robot's attempts
  Poses samples;                  ///< of the distribution
  double free_share = 0;          ///< of the samples, in the scene, 0 to 1
  double uniform_free_share = 0;  ///< of as many uniform ones
  std::vector<std::vector<page::Bone>>
      postures;  ///< five samples that are free, far from each other
  Comparison comparison;
  MeanInterval uniform_checks, guided_checks;  ///< means with 95 % intervals
};

/// Reads the run and draws the samples (seeded: equal files, equal page).
/// \throws Failure that names the file if one is missing or broken.
PageData read_run(const RunFolder& run);

}  // namespace kinship::experiments
