#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "server/fitting/distribution_key.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/experience_store.hpp"
#include "server/transfer/scene_filter.hpp"
#include "server/transfer/target_robot.hpp"

namespace kinship::fitting {

/// Effect of a recorded scene on the configurations of a target.
struct PathScene {
  transfer::ConfigurationFilter keep;  ///< empty: nothing is left out
  /// An object that a moving link of the target touches in almost every configuration and that is
  /// therefore ignored, as text; empty if there is none. (A base that touches its table is not
  /// mentioned.)
  std::string ignored;
  bool is_approximate = false;  ///< some of its things are solids around meshes
  bool is_damaged = false;      ///< it could not be read; a report may restore it
};

/// The recorded scenes of one fit as filters for its target at its placement, one for each content.
/// Used by one thread.
class SceneFilters {
 public:
  /// \param store, key, target  outlive it.
  /// \param prepared  the target.
  SceneFilters(const store::ExperienceStore& store, const DistributionKey& key,
               const runtime::Robot& target, const transfer::TargetRobot& prepared)
      : store_(store), key_(key), target_(target), prepared_(prepared) {}

  /// The scene of a path; without a filter if the profile has none, the path has no scene or a
  /// damaged one, or the target has no shapes. Valid until the next call.
  /// \throws Failure(Storage)
  const PathScene& find(const store::StoredPath& path);

 private:
  static constexpr std::size_t kMax = 64;  ///< filters in memory, about 0.1 MB each
  PathScene read(std::int64_t scene_id) const;
  std::string ignored_of(const transfer::SceneFilter& filter) const;

  const PathScene none_;

  const store::ExperienceStore& store_;
  const DistributionKey& key_;
  const runtime::Robot& target_;
  const transfer::TargetRobot prepared_;
  std::map<std::int64_t, PathScene> scenes_;  // by scene id
};

}  // namespace kinship::fitting
