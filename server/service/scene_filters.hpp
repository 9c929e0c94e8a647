#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "server/service/distribution_key.hpp"
#include "server/service/robot_registry.hpp"
#include "server/store/store.hpp"
#include "server/transfer/scene_filter.hpp"

namespace kinship::service {

/// The recorded scenes of one fit as filters for its target at its placement, one for each content.
/// Used by one thread.
class SceneFilters {
 public:
  /// \param store, key, target  outlive it.
  SceneFilters(const store::Store& store, const DistributionKey& key, const Robot& target)
      : store_(store), key_(key), target_(target) {}

  /// The filter of a path's scene; empty if the profile wants none, the path came without a scene
  /// or its scene is damaged, or the target has no shapes.
  /// \throws Failure(Storage)
  const transfer::Keep& find(const store::StoredPath& path);

  /// The first object found so far that a moving link of the target touches wherever it goes, and
  /// that was therefore not looked at, in words; empty if there was none. (That a base touches the
  /// table it stands on is no news.)
  const std::string& ignored() const noexcept { return ignored_; }

 private:
  static constexpr std::size_t kMost = 64;  ///< filters in memory, about 0.1 MB each
  void note_ignored(const transfer::SceneFilter& filter);

  const transfer::Keep none_;

  const store::Store& store_;
  const DistributionKey& key_;
  const Robot& target_;
  std::map<std::int64_t, transfer::Keep> filters_;  // by scene id
  std::string ignored_;
};

}  // namespace kinship::service
