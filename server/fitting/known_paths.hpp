#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "proto/types/uuid.hpp"
#include "server/transfer/transferred_path.hpp"

namespace kinship::fitting {

/// The transfer of one stored path to one target, and the effect of its recorded scene.
struct KnownPath {
  Uuid report;  ///< of the path
  std::shared_ptr<const transfer::TransferredPath> path;
  bool has_scene = false;              ///< it was filtered by one
  bool has_approximate_scene = false;  ///< by one with solids around meshes
  bool lacks_scene = false;            ///< its scene is wanted but damaged; it may be restored
  std::string scene_problem;           ///< an ignored object of the scene; empty: none
};

/// The paths that a fit used, by their number in the store. A stored path never changes, and its
/// transfer is a function of the path and of the inputs in the distribution's id: so the transfer
/// of a path that is read again need not be repeated.
using KnownPaths = std::map<std::int64_t, KnownPath>;

/// Approximate memory of the paths, bytes.
std::size_t size_of(const KnownPaths& paths);

}  // namespace kinship::fitting
