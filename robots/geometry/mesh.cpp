#include "robots/geometry/mesh.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <string>
#include <vector>

#include "proto/types/failure.hpp"
#include "robots/geometry/number_words.hpp"
#include "robots/geometry/stl_file.hpp"

namespace kinship::geometry {
namespace {

constexpr std::array<std::string_view, 3> kFormats = {"stl", "obj", "dae"};

/// The corners of a scene's meshes where its nodes put them.
class Corners {
 public:
  explicit Corners(const aiScene& scene) : scene_(scene) {
    if (scene.mRootNode != nullptr)
      add(*scene.mRootNode, aiMatrix4x4());
  }

  std::size_t triangles() const { return triangles_; }

  Eigen::Matrix3Xd matrix() const {
    return Eigen::Map<const Eigen::Matrix3Xd>(values_.data(), 3,
                                              static_cast<Eigen::Index>(values_.size() / 3));
  }

 private:
  // Assimp's readers limit how deep nodes are nested only by the file's size: no recursion.
  void add(const aiNode& root, const aiMatrix4x4& T_root) {
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> open = {{&root, T_root}};
    while (!open.empty() && triangles_ <= kMaxMeshTriangles) {
      const auto [node, T_parent] = open.back();
      open.pop_back();
      const aiMatrix4x4 T_node = T_parent * node->mTransformation;
      for (unsigned i = 0; i < node->mNumMeshes && triangles_ <= kMaxMeshTriangles; ++i)
        add(*scene_.mMeshes[node->mMeshes[i]], T_node);
      for (unsigned i = 0; i < node->mNumChildren; ++i)
        open.emplace_back(node->mChildren[i], T_node);
    }
  }

  void add(const aiMesh& mesh, const aiMatrix4x4& T) {
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices < 3)
        continue;  // a point or a line
      triangles_ += face.mNumIndices - 2;
      if (triangles_ > kMaxMeshTriangles)
        return;
      for (unsigned k = 2; k < face.mNumIndices; ++k)  // a fan around the face's first corner
        for (const unsigned at : {0U, k - 1, k})
          add(T * mesh.mVertices[face.mIndices[at]]);
    }
  }

  void add(const aiVector3D& corner) {
    values_.insert(values_.end(), {static_cast<double>(corner.x), static_cast<double>(corner.y),
                                   static_cast<double>(corner.z)});
  }

  const aiScene& scene_;
  std::size_t triangles_ = 0;
  std::vector<double> values_;
};

/// The corners of an OBJ or DAE file.
Result<Eigen::Matrix3Xd> read_with_assimp(std::string_view bytes, const std::string& ending) {
  try {
    ending == "obj" ? require_obj_numbers(bytes) : require_dae_numbers(bytes);
  } catch (const Failure& failure) {
    return failure.error();
  }
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* const scene =
      importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, ending.c_str());
  if (scene == nullptr)
    return invalid_input(std::string("cannot be read as ") + ending + ": " +
                         importer.GetErrorString());
  const Corners corners(*scene);
  if (corners.triangles() > kMaxMeshTriangles)
    return Error{ErrorCode::TooLarge, std::to_string(corners.triangles()) +
                                          " triangles or more exceed " +
                                          std::to_string(kMaxMeshTriangles)};
  return corners.matrix();
}

}  // namespace

Result<Eigen::Matrix3Xd> read_mesh(std::string_view bytes, std::string_view format) {
  std::string ending(format);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kFormats.begin(), kFormats.end(), ending) == kFormats.end())
    return invalid_input("format '" + std::string(format) + "' is not one of stl, obj, dae");
  if (bytes.size() > kMaxMeshBytes)
    return Error{ErrorCode::TooLarge,
                 std::to_string(bytes.size()) + " bytes exceed " + std::to_string(kMaxMeshBytes)};
  Result<Eigen::Matrix3Xd> corners =
      ending == "stl" ? read_stl(bytes) : read_with_assimp(bytes, ending);
  if (!corners)
    return corners;
  if (corners->cols() == 0)
    return invalid_input("holds no triangles");
  if (!corners->allFinite())
    return invalid_input("holds a coordinate that is not finite");
  return corners;
}

}  // namespace kinship::geometry
