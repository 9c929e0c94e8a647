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

std::size_t read_solid_count(ByteReader& in, std::size_t limit) {
  const std::uint64_t count = in.integer();
  if (count > limit)
    throw std::out_of_range("mesh solids: " + std::to_string(count) + " entries");
  return count;
}

LinkSolid read_link_solid(ByteReader& in) {
  LinkSolid solid;
  solid.link = in.text(kMaxLinkNameBytes);
  ShapeNumbers numbers;
  numbers.kind = read_solid_count(in, std::variant_size_v<Shape> - 1);
  for (double& size : numbers.sizes)
    size = in.real();
  solid.shape = to_shape(numbers);
  std::array<std::uint8_t, 7 * sizeof(double)> pose{};
  in.bytes(pose);
  const std::optional<Eigen::Isometry3d> T = pose_from_blob(pose);
  if (!T)
    throw std::out_of_range("mesh solids: seven numbers that are no pose");
  solid.T_link_shape = *T;
  return solid;
}

MeshSolids read_solids_and_pairs(ByteReader& in) {
  if (in.integer() != kSolidsFormat)
    throw std::out_of_range("mesh solids: unknown format");
  MeshSolids mesh_solids;
  for (std::size_t count = read_solid_count(in, kMaxMeshSolids); count > 0; --count)
    mesh_solids.solids.push_back(read_link_solid(in));
  for (std::size_t count = read_solid_count(in, kMaxCollisionPairs); count > 0; --count) {
    std::string first = in.text(kMaxLinkNameBytes);
    mesh_solids.unfiltered.emplace_back(std::move(first), in.text(kMaxLinkNameBytes));
  }
  if (!in.at_end())
    throw std::out_of_range("mesh solids: bytes after their end");
  return mesh_solids;
}

}  // namespace

std::vector<std::uint8_t> encode_mesh_solids(const MeshSolids& mesh_solids) {
  if (mesh_solids.solids.empty())
    return {};
  ByteWriter out;
  out.add(kSolidsFormat).add(std::uint64_t{mesh_solids.solids.size()});
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
  return out.bytes();
}

std::optional<MeshSolids> decode_mesh_solids(std::span<const std::uint8_t> bytes) {
  if (bytes.empty())
    return MeshSolids();
  try {
    ByteReader in(bytes);
    MeshSolids mesh_solids = read_solids_and_pairs(in);
    if (check_mesh_solids(mesh_solids))
      return std::nullopt;
    return mesh_solids;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
}

}  // namespace kinship::store
