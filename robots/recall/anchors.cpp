#include "robots/recall/anchors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

namespace kinship::recall {
namespace {

constexpr double kSame = 1e-3;  // m, and of the entries of a rotation

using Motions = std::vector<Eigen::Isometry3d>;  // from the first scene to each other one

/// Of an object, in the task frame; nothing if a scene has none of that name.
std::optional<Motions> motions_of(const SceneObject& first,
                                  const std::vector<const std::vector<SceneObject>*>& scenes) {
  Motions motions;
  for (const auto* scene : scenes) {
    const auto here = std::ranges::find(*scene, first.name, &SceneObject::name);
    if (here == scene->end() || here->shape.index() != first.shape.index())
      return std::nullopt;
    motions.push_back(here->T_task_object * first.T_task_object.inverse(Eigen::Isometry));
  }
  return motions;
}

bool are_alike(const Motions& a, const Motions& b) {
  return std::ranges::equal(a, b, [](const Eigen::Isometry3d& x, const Eigen::Isometry3d& y) {
    return (x.matrix() - y.matrix()).cwiseAbs().maxCoeff() < kSame;
  });
}

}  // namespace

std::vector<std::string> choose_anchors(const std::vector<const std::vector<SceneObject>*>& scenes,
                                        std::size_t most) {
  struct Group {
    std::string name;
    Motions motions;
    std::size_t size = 0;
  };
  std::vector<Group> groups;
  if (scenes.empty())
    return {};
  const Motions still(scenes.size(), Eigen::Isometry3d::Identity());
  for (const SceneObject& object : *scenes.front()) {
    const std::optional<Motions> motions = motions_of(object, scenes);
    if (!motions || are_alike(*motions, still))
      continue;
    const auto known = std::ranges::find_if(
        groups, [&](const Group& group) { return are_alike(group.motions, *motions); });
    if (known == groups.end())
      groups.push_back({object.name, *motions, 1});
    else
      ++known->size;
  }
  std::ranges::stable_sort(groups, std::ranges::greater{}, &Group::size);
  if (!groups.empty() && groups.front().size > 1)
    std::erase_if(groups, [](const Group& group) { return group.size == 1; });
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(most, groups.size()); ++i)
    names.push_back(groups[i].name);
  return names;
}

}  // namespace kinship::recall
