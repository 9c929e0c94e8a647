#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/scene.hpp"
#include "robots/models/mesh_files.hpp"

namespace kinship::models {

/// Reads the meshes and point clouds that problems name. A file is read once for each scale or size
/// of voxels; its content is kept, and shared by all scenes that name it.
class SceneMeshes {
 public:
  /// \param problem_folder  for relative names.
  SceneMeshes(std::filesystem::path problem_folder, PackageFolders packages)
      : files_(std::move(problem_folder), std::move(packages)) {}

  /// Fills in the triangles of a scene's meshes and of attached ones, and the voxels of its point
  /// clouds.
  /// \return the error of MeshFiles, with the object named; nothing without an error.
  std::optional<Error> read(Scene& scene, std::vector<AttachedObject>& attached);

 private:
  using Key = std::tuple<std::string, double, double, double>;  // file and scale

  std::optional<Error> read(const std::string& what, Mesh& mesh);
  std::optional<Error> read(const std::string& what, PointCloud& cloud);

  MeshFiles files_;
  std::map<Key, std::shared_ptr<const Eigen::Matrix3Xd>> known_;
  std::map<std::pair<std::string, double>, std::shared_ptr<const Eigen::Matrix3Xd>> voxels_;
};

}  // namespace kinship::models
