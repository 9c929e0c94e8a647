#include "server/store/values/mesh_solids_blob.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/recorded_scene.hpp"
#include "server/store/values/byte_stream.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kSolidsFormat = 1;  // written first
constexpr std::uint64_t kMeshesFormat = 2;  // the same, then meshes
constexpr std::size_t kColorNumbers = 4;

std::size_t read_solid_count(ByteReader& in, std::size_t limit) {
  const std::uint64_t count = in.integer();
  if (count > limit)
    throw std::out_of_range("mesh solids: " + std::to_string(count) + " entries");
  return count;
}

Eigen::Isometry3d read_pose(ByteReader& in) {
  std::array<std::uint8_t, 7 * sizeof(double)> pose{};
  in.bytes(pose);
  const std::optional<Eigen::Isometry3d> T = pose_from_blob(pose);
  if (!T)
    throw std::out_of_range("mesh solids: seven numbers that are no pose");
  return *T;
}

LinkSolid read_link_solid(ByteReader& in) {
  LinkSolid solid;
  solid.link = in.text(kMaxLinkNameBytes);
  ShapeNumbers numbers;
  numbers.kind = read_solid_count(in, std::variant_size_v<Shape> - 1);
  for (double& size : numbers.sizes)
    size = in.real();
  solid.shape = to_shape(numbers);
  solid.T_link_shape = read_pose(in);
  return solid;
}

LinkMesh read_link_mesh(ByteReader& in) {
  LinkMesh mesh;
  mesh.link = in.text(kMaxLinkNameBytes);
  mesh.role = static_cast<MeshRole>(read_solid_count(in, static_cast<std::size_t>(MeshRole::Both)));
  mesh.T_link_mesh = read_pose(in);
  for (std::size_t count = read_solid_count(in, kColorNumbers); count > 0; --count)
    mesh.rgba.push_back(in.real());
  mesh.error_m = in.real();
  in.bytes(mesh.content.bytes);
  return mesh;
}

StoredGeometry read_geometry(ByteReader& in) {
  const std::uint64_t format = in.integer();
  if (format != kSolidsFormat && format != kMeshesFormat)
    throw std::out_of_range("mesh solids: unknown format");
  StoredGeometry read;
  for (std::size_t count = read_solid_count(in, kMaxMeshSolids); count > 0; --count)
    read.solids.solids.push_back(read_link_solid(in));
  for (std::size_t count = read_solid_count(in, kMaxCollisionPairs); count > 0; --count) {
    std::string first = in.text(kMaxLinkNameBytes);
    read.solids.unfiltered.emplace_back(std::move(first), in.text(kMaxLinkNameBytes));
  }
  if (format == kMeshesFormat)
    for (std::size_t count = read_solid_count(in, kMaxLinkMeshes); count > 0; --count)
      read.meshes.push_back(read_link_mesh(in));
  if (!in.at_end())
    throw std::out_of_range("mesh solids: bytes after their end");
  return read;
}

}  // namespace

std::vector<std::uint8_t> encode_geometry(const RobotDescription& description) {
  const MeshSolids& mesh_solids = description.mesh_solids;
  if (mesh_solids.solids.empty() && description.meshes.empty())
    return {};
  ByteWriter out;
  out.add(description.meshes.empty() ? kSolidsFormat : kMeshesFormat)
      .add(std::uint64_t{mesh_solids.solids.size()});
  for (const LinkSolid& solid : mesh_solids.solids) {
    const ShapeNumbers numbers = to_numbers(solid.shape);
    out.add(solid.link).add(std::uint64_t{numbers.kind});
    for (const double size : numbers.sizes)
      out.add(size);
    out.add(std::span<const std::uint8_t>(pose_blob(solid.T_link_shape)));
  }
  out.add(std::uint64_t{mesh_solids.unfiltered.size()});
  for (const auto& [first, second] : mesh_solids.unfiltered)
    out.add(first).add(second);
  if (description.meshes.empty())
    return out.bytes();
  out.add(std::uint64_t{description.meshes.size()});
  for (const LinkMesh& mesh : description.meshes) {
    out.add(mesh.link).add(static_cast<std::uint64_t>(mesh.role));
    out.add(std::span<const std::uint8_t>(pose_blob(mesh.T_link_mesh)));
    out.add(std::uint64_t{mesh.rgba.size()});
    for (const double part : mesh.rgba)
      out.add(part);
    out.add(mesh.error_m).add(std::span<const std::uint8_t>(mesh.content.bytes));
  }
  return out.bytes();
}

std::optional<StoredGeometry> decode_geometry(std::span<const std::uint8_t> bytes) {
  if (bytes.empty())
    return StoredGeometry();
  try {
    ByteReader in(bytes);
    StoredGeometry read = read_geometry(in);
    if (check_mesh_solids(read.solids) || check_link_meshes(read.meshes))
      return std::nullopt;
    return read;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
}

}  // namespace kinship::store
