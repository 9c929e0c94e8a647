#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "proto/types/result.hpp"
#include "proto/types/scene.hpp"
#include "robots/geometry/point_file.hpp"

namespace kinship::models {

/// Folders of the packages of robot descriptions, by name.
using PackageFolders = std::map<std::string, std::filesystem::path>;

/// "NAME=DIR" each.
/// \return InvalidInput or NotFound with the argument if one is malformed, names a package twice
///         or a folder that does not exist.
Result<PackageFolders> parse_packages(const std::vector<std::string>& arguments);

/// The files that URDFs and problems name. Not shared between threads: it keeps the folders of the
/// packages that it found.
class MeshFiles {
 public:
  /// \param urdf_folder  of the URDF file, for relative names and the packages above it.
  /// \param packages     count before those that find_ros_package() finds.
  /// \param folders      where a file is looked for that is not there, or in no known package: by
  ///                     as much of the end of its name as a folder has.
  MeshFiles(std::filesystem::path urdf_folder, PackageFolders packages,
            std::vector<std::filesystem::path> folders = {})
      : urdf_folder_(std::move(urdf_folder)),
        packages_(std::move(packages)),
        folders_(std::move(folders)) {}

  /// The file of a mesh: package://NAME/FILE, file:///FILE, or a file name.
  /// \return InvalidInput with the URI; of a package that is not found with the searched places and
  ///         the option that helps.
  Result<std::filesystem::path> find(const std::string& uri) const;

  /// The corners of a mesh: a geometry::MeshSource.
  /// \return NotFound, InvalidInput or TooLarge with URI, file and limit.
  Result<std::optional<Eigen::Matrix3Xd>> read(const std::string& uri) const;

  /// The points of a point cloud's file.
  /// \return as read().
  Result<geometry::FilePoints> read_points(const std::string& uri) const;

 private:
  /// \param parse  parses a file's content, by the ending of the file's name.
  template <typename Content>
  Result<Content> read_file(const std::string& what, const std::string& uri, std::size_t max_bytes,
                            Result<Content> (*parse)(std::string_view, std::string_view)) const;

  /// A file as it is, or as the folders have it.
  std::filesystem::path or_in_folders(std::filesystem::path file) const;

  std::filesystem::path urdf_folder_;
  mutable PackageFolders packages_;  // and those that were found
  std::vector<std::filesystem::path> folders_;
};

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
