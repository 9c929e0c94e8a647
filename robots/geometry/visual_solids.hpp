#pragma once

#include <string>
#include <vector>

#include "proto/types/result.hpp"

namespace kinship::geometry {

/// Name of the collision elements that with_visual_solids() makes.
inline constexpr const char* kFromVisual = "kinship:from_visual";

/// The URDF with the visuals of every link without collision element copied as collision elements,
/// with their origins.
/// \param except  links that get none.
/// \return InvalidInput for a text that is no XML with a `robot` element.
Result<std::string> with_visual_solids(const std::string& urdf,
                                       const std::vector<std::string>& except = {});

}  // namespace kinship::geometry
