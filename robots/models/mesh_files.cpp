#include "robots/models/mesh_files.hpp"

#include <string_view>
#include <system_error>

#include "proto/types/number_text.hpp"
#include "robots/geometry/mesh.hpp"
#include "robots/geometry/point_cloud.hpp"
#include "robots/models/ros_packages.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::models {
namespace {

constexpr std::string_view kPackage = "package://";
constexpr std::string_view kFile = "file://";

/// The file that a folder has with as much of the end of a name as possible; empty: none.
std::filesystem::path find_in(const std::vector<std::filesystem::path>& folders,
                              const std::filesystem::path& name) {
  std::error_code unreadable;
  for (auto first = name.begin(); first != name.end(); ++first) {
    std::filesystem::path end;
    for (auto part = first; part != name.end(); ++part)
      end /= *part;
    for (const std::filesystem::path& folder : folders)
      if (std::filesystem::is_regular_file(folder / end, unreadable))
        return folder / end;
  }
  return {};
}

}  // namespace

Result<PackageFolders> parse_packages(const std::vector<std::string>& arguments) {
  PackageFolders folders;
  for (const std::string& argument : arguments) {
    const std::string what = "--package '" + argument + "': ";
    const std::size_t equals = argument.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == argument.size())
      return invalid_input(what + "must be NAME=DIR");
    const std::filesystem::path folder = argument.substr(equals + 1);
    std::error_code unreadable;
    if (!std::filesystem::is_directory(folder, unreadable))
      return Error{ErrorCode::NotFound, what + "no such folder"};
    if (!folders.emplace(argument.substr(0, equals), folder).second)
      return invalid_input(what + "the package is named twice");
  }
  return folders;
}

Result<std::filesystem::path> MeshFiles::find(const std::string& uri) const {
  const std::string_view text = uri;
  const auto wrong_uri = [&](const std::string& problem) {
    return invalid_input("mesh '" + uri + "': " + problem);
  };
  if (text.starts_with(kPackage)) {
    const std::string_view rest = text.substr(kPackage.size());
    const std::size_t slash = rest.find('/');
    if (slash == 0 || slash == std::string_view::npos || slash + 1 == rest.size())
      return wrong_uri("must be package://NAME/FILE");
    const std::string name(rest.substr(0, slash));
    if (name == "." || name == "..")
      return wrong_uri("'" + name + "' is no package");
    auto folder = packages_.find(name);
    if (folder == packages_.end()) {
      PackageSearch search = find_ros_package(name, urdf_folder_);
      if (!search.folder)
        if (std::filesystem::path file = find_in(folders_, rest.substr(slash + 1)); !file.empty())
          return file;
      if (!search.folder)
        return wrong_uri("the folder of package '" + name + "' is not known; give --package " +
                         name + "=DIR. Searched: " + search.places);
      folder = packages_.emplace(name, *std::move(search.folder)).first;
    }
    return or_in_folders(folder->second / rest.substr(slash + 1));
  }
  if (text.starts_with(kFile)) {
    const std::string_view file = text.substr(kFile.size());
    if (!file.starts_with('/'))
      return wrong_uri("must be file:///FILE with a path from the root");
    return or_in_folders(file);
  }
  if (text.find("://") != std::string_view::npos)
    return wrong_uri("is not package://, file:// or a file name");
  if (text.empty())
    return wrong_uri("names no file");
  return or_in_folders(urdf_folder_ / uri);
}

std::filesystem::path MeshFiles::or_in_folders(std::filesystem::path file) const {
  std::error_code unreadable;
  if (folders_.empty() || std::filesystem::is_regular_file(file, unreadable))
    return file;
  std::filesystem::path found = find_in(folders_, file.relative_path());
  return found.empty() ? file : found;
}

template <typename Content>
Result<Content> MeshFiles::read_file(const std::string& what, const std::string& uri,
                                     std::size_t max_bytes,
                                     Result<Content> (*parse)(std::string_view,
                                                              std::string_view)) const {
  const auto file = find(uri);
  if (!file)
    return file.error();
  const auto named = [&](const Error& error, const std::string& name) {
    return Error{error.code, what + " '" + uri + "': " + name + error.message};
  };
  try {
    const std::string ending = file->extension().string();
    auto content = parse(read_text(*file, max_bytes), ending.empty() ? ending : ending.substr(1));
    if (!content)
      return named(content.error(), file->string() + ": ");
    return content;
  } catch (const Failure& failure) {
    return named(failure.error(), "");
  }
}

Result<std::optional<Eigen::Matrix3Xd>> MeshFiles::read(const std::string& uri) const {
  auto corners = read_file("mesh", uri, geometry::kMaxMeshBytes, geometry::read_mesh);
  if (!corners)
    return corners.error();
  return std::optional<Eigen::Matrix3Xd>(*std::move(corners));
}

Result<geometry::FilePoints> MeshFiles::read_points(const std::string& uri) const {
  return read_file("point cloud", uri, geometry::kMaxCloudBytes, geometry::read_points);
}

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
