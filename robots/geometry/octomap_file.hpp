#pragma once

#include <string_view>

#include "robots/geometry/point_file.hpp"

namespace kinship::geometry {

/// The occupied cubes of an OctoMap file, with (.ot) or without (.bt) probabilities; a cube is
/// occupied from one half on. A corner of a cube lies a millionth of its edge inside it.
///
/// OctoMap's own reader recurses as deep as a damaged file says, and takes missing parts for free.
/// \throws Failure(InvalidInput) if it is no OctoMap, of another kind than OcTree, truncated,
///         longer than its tree or deeper than 16 levels; Failure(TooLarge) above a million cubes.
/// Source: Hornung et al., OctoMap (2013), section 3.5; octomap 1.9, OcTreeBaseImpl::readData and
/// OccupancyOcTreeBase::readBinaryNode.
FilePoints read_octomap(std::string_view file);

}  // namespace kinship::geometry
