#include "server/fitting/scene_filters.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace kinship::fitting {

const PathScene& SceneFilters::find(const store::StoredPath& path) {
  if (!key_.profile.transfer.avoid_recorded_scene || !path.scene_id ||
      target_.shapes.shapes.empty())
    return none_;
  const auto known = scenes_.find(*path.scene_id);
  if (known != scenes_.end())
    return known->second;
  PathScene scene = read(*path.scene_id);
  if (scenes_.size() >= kMax)
    scenes_.clear();
  return scenes_.emplace(*path.scene_id, std::move(scene)).first->second;
}

PathScene SceneFilters::read(std::int64_t scene_id) const {
  PathScene result;
  const std::optional<RecordedScene> scene = store_.read_scene(scene_id);
  result.is_damaged = !scene;
  if (!scene)
    return result;
  transfer::SceneFilter filter = transfer::scene_filter(
      prepared_.solids, *scene, key_.T_task_base.value_or(Eigen::Isometry3d::Identity()),
      prepared_.covers ? &prepared_.covers->solids : nullptr);
  result.is_approximate = std::ranges::any_of(scene->objects, &SceneObject::approximate) ||
                          std::ranges::any_of(scene->held, &HeldObject::approximate);
  result.ignored = ignored_of(filter);
  result.keep = std::move(filter.keep);
  return result;
}

std::string SceneFilters::ignored_of(const transfer::SceneFilter& filter) const {
  const auto moves = [this](const std::string& name) {
    const int link = target_.chain.find_link(name);
    return link >= 0 && target_.chain.links()[static_cast<std::size_t>(link)].joint >= 0;
  };
  for (const auto& [first, second] : filter.always_touching)
    if (moves(first) || moves(second))
      return "'" + first + "' touches '" + second + "' of a recorded scene wherever it goes";
  return {};
}

}  // namespace kinship::fitting
