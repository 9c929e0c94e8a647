#include "proto/codec/request_size.hpp"

#include "proto/codec/reader.hpp"
#include "proto/codec/scene_codec.hpp"
#include "proto/codec/search_codec.hpp"

namespace kinship::codec {
namespace {

/// Headers, and members of a fixed length.
constexpr std::size_t kFixedBytes = 256;
constexpr std::size_t kAttemptBytes = 256;  // its record, digest and UUID
constexpr std::size_t kSolidBytes = 128;
constexpr std::size_t kPairBytes = 64;
constexpr std::size_t kMeshBytes = 256;

}  // namespace

RequestSize size_of(const kinship_wire_RegisterRequest& wire) {
  std::size_t bytes =
      kFixedBytes + text_bytes(wire.urdf) + kSolidBytes * elements(wire.mesh_solids).size() +
      kPairBytes * (elements(wire.never_colliding).size() + elements(wire.unfiltered).size()) +
      kMeshBytes * elements(wire.meshes).size();
  for (const kinship_wire_MeshContent& content : elements(wire.contents))
    bytes += elements(content.zlib).size();
  return {.bytes = bytes};
}

RequestSize size_of(const kinship_wire_ReportRequest& wire) {
  const auto attempts = elements(wire.attempts);
  RequestSize size{.bytes = kFixedBytes, .attempts = attempts.size()};
  for (const kinship_wire_Attempt& attempt : attempts) {
    size.bytes += kAttemptBytes + sizeof(double) * elements(attempt.waypoints).size();
    for (const kinship_wire_RecordedScene& scene : elements(attempt.scene))
      size.bytes += scene_bytes(scene);
    for (const kinship_wire_SearchRecord& search : elements(attempt.search))
      size.bytes += search_bytes(search);
  }
  return size;
}

RequestSize size_of(const kinship_wire_FetchRequest& wire) {
  std::size_t bytes = kFixedBytes + text_bytes(wire.task) + text_bytes(wire.profile);
  for (const kinship_wire_Selection& selection : elements(wire.selection))
    bytes += elements(selection.sources).size();
  return {.bytes = bytes};
}

RequestSize size_of(const kinship_wire_AdminRequest& wire) {
  return {.bytes = kFixedBytes + text_bytes(wire.argument) + text_bytes(wire.robot) +
                   text_bytes(wire.task) + text_bytes(wire.cursor)};
}

}  // namespace kinship::codec
