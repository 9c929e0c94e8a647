#include "robots/models/scene_meshes.hpp"

#include "proto/types/number_text.hpp"
#include "robots/geometry/point_cloud.hpp"

namespace kinship::models {

std::optional<Error> SceneMeshes::read(Scene& scene, std::vector<AttachedObject>& attached) {
  for (SceneMesh& object : scene.meshes)
    if (auto error = read("scene object '" + object.name + "'", object.mesh))
      return error;
  for (SceneCloud& object : scene.clouds)
    if (auto error = read("scene object '" + object.name + "'", object.cloud))
      return error;
  for (AttachedObject& object : attached)
    if (object.mesh)
      if (auto error = read("attached object '" + object.name + "'", *object.mesh))
        return error;
  return std::nullopt;
}

std::optional<Error> SceneMeshes::read(const std::string& what, Mesh& mesh) {
  const Key key{mesh.file, mesh.scale.x(), mesh.scale.y(), mesh.scale.z()};
  auto known = known_.find(key);
  if (known == known_.end()) {
    const auto corners = files_.read(mesh.file);
    if (!corners)
      return Error{corners.error().code, what + ": " + corners.error().message};
    known = known_
                .emplace(key, std::make_shared<const Eigen::Matrix3Xd>(mesh.scale.asDiagonal() *
                                                                       **corners))
                .first;
  }
  mesh.triangles = known->second;
  return std::nullopt;
}

std::optional<Error> SceneMeshes::read(const std::string& what, PointCloud& cloud) {
  auto& voxels = voxels_[{cloud.file, cloud.voxel_m}];
  if (!voxels) {
    const auto points = files_.read_points(cloud.file);
    if (!points)
      return Error{points.error().code, what + ": " + points.error().message};
    const std::string named = what + ": point cloud '" + cloud.file + "': ";
    if (const double cube_m = points->cube_m; cloud.voxel_m < (1 - 1e-9) * cube_m)
      return Error{ErrorCode::InvalidInput, named + "a map of cubes of " + number_text(cube_m) +
                                                " m, but voxels of " + number_text(cloud.voxel_m) +
                                                " m: give \"voxel\": " + number_text(cube_m) +
                                                ", or a larger one"};
    auto filled = geometry::voxels_of(points->points, cloud.voxel_m);
    if (!filled)
      return Error{filled.error().code, named + filled.error().message};
    voxels = std::make_shared<const Eigen::Matrix3Xd>(std::move(filled).value());
  }
  cloud.voxels = voxels;
  return std::nullopt;
}

}  // namespace kinship::models
