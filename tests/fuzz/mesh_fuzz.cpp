// A mesh file on a client: finite corners, three a triangle, or a refusal in words. And the content
// of a mesh on a server: the first four bytes declare its size.

#include <array>
#include <cstring>

#include "proto/types/link_mesh.hpp"
#include "robots/geometry/mesh.hpp"
#include "tests/fuzz/demand.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 3> kFormats = {"stl", "obj", "dae"};
  if (size == 0)
    return 0;
  constexpr std::size_t kDeclared = 4;
  if (data[0] == 0xff && size > kDeclared) {
    kinship::MeshContent content{0, {data + 1 + kDeclared, data + size}};
    std::memcpy(&content.bytes, data + 1, kDeclared);
    const auto mesh = kinship::TriangleMesh::read(content);
    kinship::fuzz::demand_words(mesh);
    if (mesh)
      kinship::fuzz::demand(
          kinship::TriangleMesh::from_corners(mesh->corners())->digest() == mesh->digest(),
          "a mesh that was read is canonical");
    return 0;
  }
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto corners = kinship::geometry::read_mesh(bytes, kFormats.at(data[0] % kFormats.size()));
  kinship::fuzz::demand_words(corners);
  if (corners)
    kinship::fuzz::demand(corners->cols() > 0 && corners->cols() % 3 == 0 && corners->allFinite(),
                          "a mesh has triangles with finite corners");
  return 0;
}
