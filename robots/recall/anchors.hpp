#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "proto/types/scene.hpp"

namespace kinship::recall {

/// Names of objects by which furniture is known that moves between scenes: of each group of objects
/// that are in all scenes and move as one, by more than 1 mm or 1 mrad, the first, the largest
/// group first; groups of one object only if there are no others. \param scenes  of one task; not
/// null. \param most    names.
std::vector<std::string> choose_anchors(const std::vector<const std::vector<SceneObject>*>& scenes,
                                        std::size_t most);

}  // namespace kinship::recall
