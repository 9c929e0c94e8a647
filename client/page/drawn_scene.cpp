#include "client/page/drawn_scene.hpp"

#include <memory>
#include <string>

namespace kinship::page {
namespace {

void add_box_around(const std::string& name, const std::shared_ptr<const Eigen::Matrix3Xd>& points,
                    double margin_m, const Eigen::Isometry3d& T_task_points,
                    std::vector<SceneObject>& objects) {
  if (points == nullptr || points->cols() == 0)
    return;
  const Eigen::Vector3d lower = points->rowwise().minCoeff().array() - margin_m;
  const Eigen::Vector3d upper = points->rowwise().maxCoeff().array() + margin_m;
  objects.push_back({name, BoxShape{upper - lower},
                     T_task_points * Eigen::Translation3d((lower + upper) / 2), true});
}

}  // namespace

std::vector<SceneObject> drawn_objects(const Scene& scene) {
  std::vector<SceneObject> objects = scene.objects;
  for (const SceneMesh& each : scene.meshes)
    add_box_around(each.name, each.mesh.triangles, 0, each.T_task_mesh, objects);
  for (const SceneCloud& each : scene.clouds)
    add_box_around(each.name, each.cloud.voxels, each.cloud.voxel_m / 2, each.T_task_cloud,
                   objects);
  return objects;
}

}  // namespace kinship::page
