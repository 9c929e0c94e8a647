#include "robots/models/scene_meshes.hpp"

namespace kinship::models {

std::optional<Error> SceneMeshes::read(Scene& scene, std::vector<AttachedObject>& attached) {
  for (SceneMesh& object : scene.meshes)
    if (auto error = read("scene object '" + object.name + "'", object.mesh))
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

}  // namespace kinship::models
