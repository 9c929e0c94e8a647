#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/scene.hpp"
#include "robots/models/mesh_files.hpp"

namespace kinship::models {

/// Reads the meshes that problems name. A file is read once for each scale; what was read is kept,
/// and shared by all scenes that name it.
class SceneMeshes {
 public:
  /// \param problem_folder  where relative names start.
  SceneMeshes(std::filesystem::path problem_folder, PackageFolders packages)
      : files_(std::move(problem_folder), std::move(packages)) {}

  /// Fills in the triangles of a scene's meshes and of those that are attached.
  /// \return what MeshFiles::read says, with the object named; nothing if all went well.
  std::optional<Error> read(Scene& scene, std::vector<AttachedObject>& attached);

 private:
  using Key = std::tuple<std::string, double, double, double>;  // file and scale

  std::optional<Error> read(const std::string& what, Mesh& mesh);

  MeshFiles files_;
  std::map<Key, std::shared_ptr<const Eigen::Matrix3Xd>> known_;
};

}  // namespace kinship::models
