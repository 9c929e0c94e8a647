#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "proto/types/task_experience.hpp"

namespace kinship::fitting {

/// Shared by what knows the paths of a task and by the choices made of them: it never changes.
using SharedPosePath = std::shared_ptr<const PosePath>;

/// A task's experience without copies of its paths.
struct ExperienceChoice {
  std::uint64_t revision = 0;  ///< see TaskExperience
  std::uint64_t paths_known = 0;
  std::vector<SharedPosePath> paths;
};

/// How far two paths are apart in what they connect: distance of the starts and of the goals, each
/// in m plus 0.3 m for each rad.
double distance_of_ends(const PosePath& a, const PosePath& b);

/// As many paths as `bytes` allow (experience_bytes(), kMaxExperiencePaths), so that every path has
/// one near it in start and goal: the newest first, then always the one that is farthest from all
/// chosen ones, of several the newest. So the first few are the choice of fewer bytes.
/// Source: Gonzalez, Clustering to minimize the maximum intercluster distance (1985): at most twice
/// the largest distance that the best choice would have.
/// \param paths  in the order of arrival. O(chosen * paths).
ExperienceChoice choose_experience(const std::vector<SharedPosePath>& paths, std::size_t bytes);

/// What is left of a choice with fewer bytes; the choice itself if it has no more.
ExperienceChoice shortened(const ExperienceChoice& choice, std::size_t bytes);

TaskExperience to_experience(const ExperienceChoice& choice);

}  // namespace kinship::fitting
