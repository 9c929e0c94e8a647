#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "proto/types/task_experience.hpp"

namespace kinship::fitting {

/// Shared by the memory of a task's paths and the choices made of them: it never changes.
using SharedPosePath = std::shared_ptr<const PosePath>;

/// A task's experience without copies of its paths.
struct ExperienceChoice {
  std::uint64_t revision = 0;  ///< see TaskExperience
  std::uint64_t paths_known = 0;
  std::vector<SharedPosePath> paths;
};

/// Distance between two paths by their ends: distance of the starts and of the goals, each in m
/// plus 0.3 m for each rad.
double distance_of_ends(const PosePath& a, const PosePath& b);

/// As many paths as `bytes` allow (experience_bytes(), kMaxExperiencePaths), so that every path has
/// one near it in start and goal: the newest first, then always the one that is farthest from all
/// chosen ones, of several the newest. So a prefix of the choice is the choice for fewer bytes.
/// Source: Gonzalez, Clustering to minimize the maximum intercluster distance (1985): at most twice
/// the largest distance of the best choice.
/// \param paths  in the order of arrival. O(chosen * paths).
ExperienceChoice choose_experience(const std::vector<SharedPosePath>& paths, std::size_t bytes);

/// The choice for fewer bytes; the choice itself if it has no more.
ExperienceChoice shortened(const ExperienceChoice& choice, std::size_t bytes);

TaskExperience to_experience(const ExperienceChoice& choice);

}  // namespace kinship::fitting
