#include "proto/types/mesh_solids.hpp"

#include <array>
#include <cstddef>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/recorded_scene.hpp"

namespace kinship {
namespace {

std::optional<Error> check_link(const std::string& name) {
  if (name.empty())
    return Error{ErrorCode::InvalidInput, "mesh_solids: a link's name is empty"};
  return check_text("mesh_solids: a link's name", name, kMaxLinkNameBytes);
}

std::optional<Error> check_solid(const LinkSolid& solid) {
  if (auto error = check_link(solid.link))
    return error;
  const std::string who = "mesh_solids: '" + solid.link + "': ";
  constexpr std::array<std::size_t, 4> kSizes = {3, 2, 1, 2};  // in the order of the variant
  const ShapeNumbers numbers = to_numbers(solid.shape);
  for (std::size_t i = 0; i < kSizes.at(numbers.kind); ++i) {
    const double size = numbers.sizes.at(i);
    if (!(size > 0 && size <= kMaxPlacement_m))  // so that NaN breaks it
      return Error{ErrorCode::InvalidInput, who + "size " + number_text(size) +
                                                " m is not above 0 and at most " +
                                                number_text(kMaxPlacement_m) + " m"};
  }
  if (const auto pose = from_pose_array(to_pose_array(solid.T_link_shape)); !pose)
    return Error{pose.error().code, who + pose.error().message};
  return std::nullopt;
}

std::optional<Error> too_many_of(const char* what, std::size_t count, std::size_t limit) {
  if (count <= limit)
    return std::nullopt;
  return Error{ErrorCode::TooLarge, "mesh_solids: " + std::to_string(count) + " " + what +
                                        " exceed " + std::to_string(limit)};
}

}  // namespace

std::optional<Error> check_mesh_solids(const MeshSolids& mesh_solids) {
  if (auto error = too_many_of("solids", mesh_solids.solids.size(), kMaxMeshSolids))
    return error;
  if (auto error = too_many_of("pairs", mesh_solids.unfiltered.size(), kMaxCollisionPairs))
    return error;
  for (const LinkSolid& solid : mesh_solids.solids)
    if (auto error = check_solid(solid))
      return error;
  for (const auto& [first, second] : mesh_solids.unfiltered)
    for (const std::string* link : {&first, &second})
      if (auto error = check_link(*link))
        return error;
  return std::nullopt;
}

}  // namespace kinship
