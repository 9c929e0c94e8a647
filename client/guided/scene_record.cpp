#include "client/guided/scene_record.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "robots/geometry/mesh_cover.hpp"
#include "robots/geometry/point_cloud.hpp"

namespace kinship::guided {
namespace {

constexpr std::size_t kBoxesOfACloud = 128;  // of some 2000 objects that a scene may hold

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

Result<SceneRecords::Solids> SceneRecords::around(const Mesh& mesh, const std::string& name) {
  if (!mesh.triangles || mesh.triangles->cols() == 0)
    return invalid_input("'" + name + "' is a mesh that was not read");
  Solids& solids = solids_[mesh.triangles];
  if (!solids)
    solids = std::make_shared<const std::vector<geometry::FittedShape>>(
        geometry::cover_mesh(*mesh.triangles));
  return solids;
}

std::optional<Error> SceneRecords::add_held(const AttachedObject& held, RecordedScene& scene) {
  if (!held.mesh) {
    scene.held.push_back({held.name, held.shape, held.T_link_object});
    return std::nullopt;
  }
  const Result<Solids> solids = around(*held.mesh, held.name);
  if (!solids)
    return solids.error();
  for (const geometry::FittedShape& solid : **solids)
    scene.held.push_back({held.name, solid.shape, held.T_link_object * solid.T_points_shape, true});
  return std::nullopt;
}

Result<RecordedScene> SceneRecords::record(const Scene& given,
                                           const std::vector<AttachedObject>& held,
                                           const NamePairs& allowed_collisions) {
  RecordedScene scene;
  scene.objects = given.objects;
  for (const SceneMesh& object : given.meshes) {
    const Result<Solids> solids = around(object.mesh, object.name);
    if (!solids)
      return solids.error();
    for (const geometry::FittedShape& solid : **solids)
      scene.objects.push_back(
          {object.name, solid.shape, object.T_task_mesh * solid.T_points_shape, true});
  }
  for (const SceneCloud& object : given.clouds) {
    if (!object.cloud.voxels)
      return invalid_input("'" + object.name + "' is a point cloud that was not read");
    for (const geometry::VoxelBlock& block :
         geometry::blocks_of(*object.cloud.voxels, object.cloud.voxel_m, kBoxesOfACloud))
      scene.objects.push_back({object.name, BoxShape{block.size},
                               object.T_task_cloud * Eigen::Translation3d(block.center), true});
  }
  for (const AttachedObject& each : held)
    if (const auto error = add_held(each, scene))
      return *error;
  std::set<std::string_view> names;
  for (const SceneObject& object : scene.objects)
    names.insert(object.name);
  for (const HeldObject& each : scene.held)
    names.insert(each.name);
  for (const auto& [first, second] : allowed_collisions)
    if (names.contains(first) && names.contains(second))
      scene.allowed_collisions.emplace_back(first, second);
  if (const auto error = check_scene(scene))
    return *error;
  return scene;
}

Result<RecordedScene> SceneRecords::record(const kinematics::Chain& chain, const Problem& problem) {
  std::vector<AttachedObject> held;
  for (const AttachedObject& attached : problem.attached)
    if (const auto T = T_transfer_link(chain, attached.link)) {
      held.push_back(attached);
      held.back().T_link_object = *T * attached.T_link_object;
    }
  Result<RecordedScene> recorded = record(problem.scene, held, problem.allowed_collisions);
  if (!recorded || !problem.constraint)
    return recorded;
  RecordedScene scene = std::move(recorded).value();
  scene.constraint = problem.constraint;
  if (const auto error = check_scene(scene))
    return *error;
  return scene;
}

Result<RecordedScene> record_scene(const kinematics::Chain& chain, const Problem& problem) {
  return SceneRecords().record(chain, problem);
}

}  // namespace kinship::guided
