#include "client/planner/scene_record.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace kinship::planner {
namespace {

/// Pose of a link in the transfer frame if both are fixed to each other.
std::optional<Eigen::Isometry3d> T_transfer_link(const kinematics::Chain& chain,
                                                 const std::string& link) {
  const int link_index = chain.find_link(link), tip_index = chain.find_link(chain.tip_link());
  if (link_index < 0 || tip_index < 0)
    return std::nullopt;
  const kinematics::ChainLink& held_by = chain.links()[static_cast<std::size_t>(link_index)];
  const kinematics::ChainLink& tip = chain.links()[static_cast<std::size_t>(tip_index)];
  if (held_by.joint != tip.joint)
    return std::nullopt;
  return (tip.T_joint_link * chain.T_tip_transfer()).inverse(Eigen::Isometry) *
         held_by.T_joint_link;
}

}  // namespace

Result<RecordedScene> record_scene(const kinematics::Chain& chain, const Problem& problem) {
  const auto held_mesh = std::find_if(problem.attached.begin(), problem.attached.end(),
                                      [](const AttachedObject& each) { return each.mesh; });
  if (!problem.scene.meshes.empty() || held_mesh != problem.attached.end())
    return Error{
        ErrorCode::InvalidInput,
        "'" + (problem.scene.meshes.empty() ? held_mesh->name : problem.scene.meshes.front().name) +
            "' is a mesh, and the server keeps scenes of shapes only"};
  RecordedScene scene;
  scene.objects = problem.scene.objects;
  for (const AttachedObject& attached : problem.attached)
    if (const auto T = T_transfer_link(chain, attached.link))
      scene.held.push_back({attached.name, attached.shape, *T * attached.T_link_object});
  std::set<std::string_view> names;
  for (const SceneObject& object : scene.objects)
    names.insert(object.name);
  for (const HeldObject& held : scene.held)
    names.insert(held.name);
  for (const auto& [first, second] : problem.allowed_collisions)
    if (names.contains(first) && names.contains(second))
      scene.allowed_collisions.emplace_back(first, second);
  scene.constraint = problem.constraint;
  if (const auto error = check_scene(scene))
    return *error;
  return scene;
}

}  // namespace kinship::planner
