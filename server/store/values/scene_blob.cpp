#include "server/store/values/scene_blob.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/store/values/byte_stream.hpp"
#include "server/store/values/compression.hpp"
#include "server/store/values/crc32c.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kSceneFormat = 1;  // written first
/// Of the largest scene: a solid takes at most 112 bytes beside its name here, 96 for
/// kMaxSceneBytes.
constexpr std::int64_t kMaxPlainBytes = std::int64_t{1} << 20U;

void add(ByteWriter& out, bool flag) { out.add(std::uint64_t{flag ? 1U : 0U}); }

void add(ByteWriter& out, const std::string& name, const Shape& shape, const Eigen::Isometry3d& T,
         bool approximate) {
  const ShapeNumbers numbers = to_numbers(shape);
  out.add(name).add(std::uint64_t{numbers.kind});
  for (const double size : numbers.sizes)
    out.add(size);
  out.add(std::span<const std::uint8_t>(pose_blob(T)));
  add(out, approximate);
}

void add(ByteWriter& out, const TaskSpaceRegion& constraint) {
  out.add(std::span<const std::uint8_t>(pose_blob(constraint.T_task_region)));
  out.add(std::span<const std::uint8_t>(pose_blob(constraint.T_region_end)));
  for (const double bound : constraint.bounds.reshaped())
    out.add(bound);
}

/// A SceneObject or a HeldObject: name, shape, pose, and whether it was fitted around a mesh.
template <typename Thing>
Thing read_thing(ByteReader& in) {
  std::string name = in.text(kMaxLinkNameBytes);
  ShapeNumbers numbers;
  numbers.kind = in.integer(std::variant_size_v<Shape> - 1);
  for (double& size : numbers.sizes)
    size = in.real();
  const Shape shape = to_shape(numbers);
  const Eigen::Isometry3d T = in.bare_pose();
  return {std::move(name), shape, T, in.integer(1) == 1};
}

TaskSpaceRegion read_constraint(ByteReader& in) {
  TaskSpaceRegion constraint;
  constraint.T_task_region = in.bare_pose();
  constraint.T_region_end = in.bare_pose();
  for (double& bound : constraint.bounds.reshaped())
    bound = in.real();
  return constraint;
}

RecordedScene read_scene(ByteReader& in) {
  if (in.integer() != kSceneFormat)
    throw std::out_of_range("scene: unknown format");
  RecordedScene scene;
  for (std::size_t count = in.integer(kMaxSceneObjects); count > 0; --count)
    scene.objects.push_back(read_thing<SceneObject>(in));
  for (std::size_t count = in.integer(kMaxHeldObjects); count > 0; --count)
    scene.held.push_back(read_thing<HeldObject>(in));
  for (std::size_t count = in.integer(kMaxAllowedPairs); count > 0; --count) {
    std::string first = in.text(kMaxLinkNameBytes);
    scene.allowed_collisions.emplace_back(std::move(first), in.text(kMaxLinkNameBytes));
  }
  if (in.integer(1) == 1)
    scene.constraint = read_constraint(in);
  if (!in.at_end())
    throw std::out_of_range("scene: bytes after its end");
  return scene;
}

}  // namespace

SceneBlob encode_scene(const RecordedScene& scene) {
  ByteWriter out;
  out.add(kSceneFormat);
  out.add(std::uint64_t{scene.objects.size()});
  for (const SceneObject& object : scene.objects)
    add(out, object.name, object.shape, object.T_task_object, object.approximate);
  out.add(std::uint64_t{scene.held.size()});
  for (const HeldObject& held : scene.held)
    add(out, held.name, held.shape, held.T_transfer_object, held.approximate);
  out.add(std::uint64_t{scene.allowed_collisions.size()});
  for (const auto& [first, second] : scene.allowed_collisions)
    out.add(first).add(second);
  add(out, scene.constraint.has_value());
  if (scene.constraint)
    add(out, *scene.constraint);
  SceneBlob blob;
  blob.size = std::ssize(out.bytes());
  if (std::optional<std::vector<std::uint8_t>> compressed = compress(out.bytes())) {
    blob.encoding = SceneEncoding::Zstd;
    blob.bytes = std::move(*compressed);
  } else {
    blob.bytes = out.bytes();
  }
  return blob;
}

std::optional<RecordedScene> decode_scene(std::int64_t size, std::int64_t encoding,
                                          std::span<const std::uint8_t> bytes) {
  if (size < 1 || size > kMaxPlainBytes)
    return std::nullopt;
  std::optional<std::vector<std::uint8_t>> plain;
  if (encoding == static_cast<std::int64_t>(SceneEncoding::Zstd)) {
    plain = decompress(bytes, static_cast<std::size_t>(size));
    if (!plain)
      return std::nullopt;
    bytes = *plain;
  } else if (encoding != static_cast<std::int64_t>(SceneEncoding::Plain) ||
             std::ssize(bytes) != size) {
    return std::nullopt;
  }
  try {
    ByteReader in(bytes);
    RecordedScene scene = read_scene(in);
    if (check_scene(scene))
      return std::nullopt;
    return scene;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
}

std::uint32_t scene_crc(Bytes content, std::int64_t size, std::int64_t encoding, Bytes scene) {
  ByteWriter header;
  header.add(content);
  for (const std::int64_t number : {size, encoding})
    header.add(static_cast<std::uint64_t>(number));
  return crc32c(scene, crc32c(header.bytes()));
}

}  // namespace kinship::store
