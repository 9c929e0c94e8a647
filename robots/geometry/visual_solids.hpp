#pragma once

#include <string>
#include <vector>

#include "proto/types/result.hpp"

namespace kinship::geometry {

/// Name of the collision elements that with_visual_solids() makes.
inline constexpr const char* kFromVisual = "kinship:from_visual";

/// A URDF in which every link that is drawn and has no collision element has its visuals as
/// collision elements too, with their origins.
/// \param except  links that stay without.
/// \return InvalidInput for what is no XML with a `robot` element.
Result<std::string> with_visual_solids(const std::string& urdf,
                                       const std::vector<std::string>& except = {});

}  // namespace kinship::geometry
