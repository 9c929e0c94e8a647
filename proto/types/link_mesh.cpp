#include "proto/types/link_mesh.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>
#include <numeric>
#include <span>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/sha256.hpp"

namespace kinship {
namespace {

static_assert(std::endian::native == std::endian::little, "canonical bytes are copied");

using Vertex = std::array<float, 3>;
using Triangle = std::array<std::uint32_t, 3>;
constexpr std::size_t kCountBytes = 2 * sizeof(std::uint32_t);
constexpr std::size_t kMaxZlibRatio = 1100;  // of deflate: 1032, and its head

Error invalid(const std::string& why) { return {ErrorCode::InvalidInput, why}; }

std::optional<Error> check_link_mesh(const LinkMesh& mesh) {
  if (mesh.link.empty())
    return invalid("meshes: a link's name is empty");
  if (auto error = check_text("meshes: a link's name", mesh.link, kMaxLinkNameBytes))
    return error;
  const std::string who = "meshes: '" + mesh.link + "': ";
  if (const auto pose = from_pose_array(to_pose_array(mesh.T_link_mesh)); !pose)
    return Error{pose.error().code, who + pose.error().message};
  if (!mesh.rgba.empty() && mesh.rgba.size() != 4)
    return invalid(who + "a colour of " + std::to_string(mesh.rgba.size()) + " numbers, not 4");
  for (const double part : mesh.rgba)
    if (!(part >= 0 && part <= 1))  // so that NaN breaks it
      return invalid(who + "colour " + number_text(part) + " is not between 0 and 1");
  if (!(mesh.error_m >= 0 && mesh.error_m <= kMaxPlacement_m))
    return invalid(who + "error_m " + number_text(mesh.error_m) + " is not between 0 and " +
                   number_text(kMaxPlacement_m));
  if (mesh.error_m > 0 && is_collision(mesh))
    return invalid(who + "a mesh for collision is altered");
  return std::nullopt;
}

/// The smallest index first; the order of the corners around the triangle stays.
Triangle turned(Triangle triangle) {
  std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
  return triangle;
}

template <typename T>
void append(std::vector<std::uint8_t>& bytes, const T* values, std::size_t count) {
  const std::size_t before = bytes.size();
  bytes.resize(before + count * sizeof(T));
  if (count > 0)
    std::memcpy(bytes.data() + before, values, count * sizeof(T));
}

std::size_t bytes_of(std::uint64_t vertices, std::uint64_t triangles) {
  return kCountBytes + sizeof(Vertex) * vertices + sizeof(Triangle) * triangles;
}

Result<std::vector<std::uint8_t>> inflate(const MeshContent& content) {
  if (content.bytes > kMaxCanonicalMeshBytes)
    return Error{ErrorCode::TooLarge, "mesh: " + std::to_string(content.bytes) + " bytes exceed " +
                                          std::to_string(kMaxCanonicalMeshBytes)};
  if (content.bytes < kCountBytes || content.bytes > content.zlib.size() * kMaxZlibRatio)
    return invalid("mesh: " + std::to_string(content.zlib.size()) + " bytes cannot hold " +
                   std::to_string(content.bytes));
  std::vector<std::uint8_t> bytes(content.bytes);
  uLongf size = bytes.size();
  uLong consumed = content.zlib.size();
  const int outcome = ::uncompress2(bytes.data(), &size, content.zlib.data(), &consumed);
  if (outcome == Z_MEM_ERROR)
    throw std::bad_alloc();
  if (outcome != Z_OK || size != bytes.size() || consumed != content.zlib.size())
    return invalid("mesh: is not a zlib stream of " + std::to_string(content.bytes) + " bytes");
  return bytes;
}

}  // namespace

std::optional<Error> check_link_meshes(const std::vector<LinkMesh>& meshes) {
  if (meshes.size() > kMaxLinkMeshes)
    return Error{ErrorCode::TooLarge, "meshes: " + std::to_string(meshes.size()) + " exceed " +
                                          std::to_string(kMaxLinkMeshes)};
  for (const LinkMesh& mesh : meshes)
    if (auto error = check_link_mesh(mesh))
      return error;
  return std::nullopt;
}

Result<TriangleMesh> TriangleMesh::from_corners(const Eigen::Matrix3Xd& corners) {
  if (!corners.allFinite() || corners.size() == 0 || corners.cols() % 3 != 0 ||
      corners.cwiseAbs().maxCoeff() > kMaxPlacement_m)
    return invalid("mesh: its corners are none, not finite or beyond " +
                   number_text(kMaxPlacement_m) + " m");
  std::vector<Vertex> all(static_cast<std::size_t>(corners.cols()));
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)  // + 0: a zero without its sign
      all[i][k] =
          static_cast<float>(corners(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i))) +
          0.0F;
  std::vector<Vertex> vertices = all;
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Triangle> triangles(all.size() / 3);
  for (std::size_t i = 0; i < all.size(); ++i)
    triangles[i / 3][i % 3] =
        static_cast<std::uint32_t>(std::ranges::lower_bound(vertices, all[i]) - vertices.begin());
  std::ranges::transform(triangles, triangles.begin(), turned);
  std::ranges::sort(triangles);
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  TriangleMesh mesh;
  for (const Vertex& vertex : vertices)
    mesh.vertices_.insert(mesh.vertices_.end(), vertex.begin(), vertex.end());
  for (const Triangle& triangle : triangles)
    mesh.triangles_.insert(mesh.triangles_.end(), triangle.begin(), triangle.end());
  return mesh;
}

Result<TriangleMesh> TriangleMesh::read(const MeshContent& content) {
  const Result<std::vector<std::uint8_t>> bytes = inflate(content);
  if (!bytes)
    return bytes.error();
  std::array<std::uint32_t, 2> counts{};
  std::memcpy(counts.data(), bytes->data(), kCountBytes);
  const auto [vertices, triangles] = counts;
  if (bytes_of(vertices, triangles) != bytes->size() || vertices == 0 || triangles == 0)
    return invalid("mesh: " + std::to_string(vertices) + " vertices and " +
                   std::to_string(triangles) + " triangles are not " +
                   std::to_string(bytes->size()) + " bytes");
  TriangleMesh mesh;
  mesh.vertices_.resize(3 * std::size_t{vertices});
  mesh.triangles_.resize(3 * std::size_t{triangles});
  std::memcpy(mesh.vertices_.data(), bytes->data() + kCountBytes,
              mesh.vertices_.size() * sizeof(float));
  std::memcpy(mesh.triangles_.data(), bytes->data() + bytes_of(vertices, 0),
              mesh.triangles_.size() * sizeof(std::uint32_t));
  if (std::ranges::any_of(mesh.triangles_, [v = vertices](std::uint32_t i) { return i >= v; }) ||
      !std::ranges::all_of(mesh.vertices_, [](float x) { return std::isfinite(x); }))
    return invalid("mesh: a vertex is not finite, or a triangle has one that is not there");
  const Result<TriangleMesh> again = from_corners(mesh.corners());
  if (!again)
    return again.error();
  if (again->canonical() != *bytes)
    return invalid("mesh: its bytes are not in their canonical order");
  return mesh;
}

std::vector<std::uint8_t> TriangleMesh::canonical() const {
  const std::array<std::uint32_t, 2> counts{static_cast<std::uint32_t>(vertices_.size() / 3),
                                            static_cast<std::uint32_t>(triangles_.size() / 3)};
  std::vector<std::uint8_t> all;
  all.reserve(bytes());
  append(all, counts.data(), counts.size());
  append(all, vertices_.data(), vertices_.size());
  append(all, triangles_.data(), triangles_.size());
  return all;
}

MeshContent TriangleMesh::content() const {
  const std::vector<std::uint8_t> all = canonical();
  MeshContent content{static_cast<std::uint32_t>(all.size()), {}};
  uLongf size = ::compressBound(all.size());
  content.zlib.resize(size);
  if (::compress2(content.zlib.data(), &size, all.data(), all.size(), Z_BEST_COMPRESSION) != Z_OK)
    throw std::bad_alloc();  // the only way in which it fails with a bound like that
  content.zlib.resize(size);
  return content;
}

Digest TriangleMesh::digest() const {
  return Sha256().add(std::span<const std::uint8_t>(canonical())).finish();
}

std::size_t TriangleMesh::bytes() const {
  return bytes_of(vertices_.size() / 3, triangles_.size() / 3);
}

Eigen::Matrix3Xd TriangleMesh::corners() const {
  Eigen::Matrix3Xd corners(3, static_cast<Eigen::Index>(triangles_.size()));
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      corners(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) =
          vertices_[3 * std::size_t{triangles_[i]} + k];
  return corners;
}

}  // namespace kinship
