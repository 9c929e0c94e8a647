#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "proto/types/uuid.hpp"
#include "server/transfer/transferred_path.hpp"

namespace kinship::fitting {

/// What one stored path became for one target, and what its recorded scene had to do with it.
struct KnownPath {
  Uuid report;  ///< that brought it
  std::shared_ptr<const transfer::TransferredPath> path;
  bool has_scene = false;              ///< it was filtered by one
  bool has_approximate_scene = false;  ///< by one with solids around meshes
  bool lacks_scene = false;   ///< it should have been, but its scene is damaged; it may come back
  std::string scene_problem;  ///< what was not looked at in it
};

/// The paths that a fit used, by their number in the store. A path in the store never changes, and
/// what it becomes is a function of it and of what the distribution's id stands for: so what is
/// known of a path that is still read need not be found again.
using KnownPaths = std::map<std::int64_t, KnownPath>;

/// About what they occupy.
std::size_t size_of(const KnownPaths& paths);

}  // namespace kinship::fitting
