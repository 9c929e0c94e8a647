// A mesh file on a client: finite corners, three a triangle, or a refusal in words.

#include <array>

#include "robots/geometry/mesh.hpp"
#include "tests/fuzz/demand.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 3> kFormats = {"stl", "obj", "dae"};
  if (size == 0)
    return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto corners = kinship::geometry::read_mesh(bytes, kFormats.at(data[0] % kFormats.size()));
  kinship::fuzz::demand_words(corners);
  if (corners)
    kinship::fuzz::demand(corners->cols() > 0 && corners->cols() % 3 == 0 && corners->allFinite(),
                          "a mesh has triangles with finite corners");
  return 0;
}
