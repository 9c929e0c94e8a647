#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"
#include "robots/geometry/point_file.hpp"

namespace kinship::models {

/// Folders of the packages of robot descriptions, by name.
using PackageFolders = std::map<std::string, std::filesystem::path>;

/// "NAME=DIR" each.
/// \return InvalidInput or NotFound with the argument if one is malformed, names a package twice
///         or a folder that does not exist.
Result<PackageFolders> parse_packages(const std::vector<std::string>& arguments);

/// The files that URDFs and problems name.
class MeshFiles {
 public:
  /// \param urdf_folder  of the URDF file, for relative names.
  MeshFiles(std::filesystem::path urdf_folder, PackageFolders packages)
      : urdf_folder_(std::move(urdf_folder)), packages_(std::move(packages)) {}

  /// The file of a mesh: package://NAME/FILE, file:///FILE, or a file name.
  /// \return InvalidInput with the URI, and with the option that helps if it names a package with
  ///         unknown folder.
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

  std::filesystem::path urdf_folder_;
  PackageFolders packages_;
};

}  // namespace kinship::models
