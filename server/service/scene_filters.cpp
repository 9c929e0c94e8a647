#include "server/service/scene_filters.hpp"

#include <optional>
#include <utility>

namespace kinship::service {

const transfer::Keep& SceneFilters::find(const store::StoredPath& path) {
  if (!key_.profile.transfer.avoid_recorded_scene || !path.scene_id ||
      target_.shapes.shapes.empty())
    return none_;
  const auto known = filters_.find(*path.scene_id);
  if (known != filters_.end())
    return known->second;
  transfer::SceneFilter filter;
  if (const std::optional<RecordedScene> scene = store_.read_scene(*path.scene_id))
    filter = transfer::scene_filter(target_.chain, target_.shapes, *scene,
                                    key_.T_task_base.value_or(Eigen::Isometry3d::Identity()));
  note_ignored(filter);
  if (filters_.size() >= kMost)
    filters_.clear();
  return filters_.emplace(*path.scene_id, std::move(filter.keep)).first->second;
}

void SceneFilters::note_ignored(const transfer::SceneFilter& filter) {
  const auto moves = [this](const std::string& name) {
    const int link = target_.chain.find_link(name);
    return link >= 0 && target_.chain.links()[static_cast<std::size_t>(link)].joint >= 0;
  };
  for (const auto& [first, second] : filter.always_touching)
    if (ignored_.empty() && (moves(first) || moves(second)))
      ignored_ = "'" + first + "' touches '" + second + "' of a recorded scene wherever it goes";
}

}  // namespace kinship::service
