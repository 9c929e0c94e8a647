#pragma once

#include <utility>
#include <vector>

#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// Pairs of links that hold shapes, are joined by one moving joint of the chain, and have no
/// other link with a shape between them in the kinematic tree: they meet at that joint.
/// \param has_shape  one entry per link of chain.links().
/// \return           link indices, first < second, sorted.
std::vector<std::pair<int, int>> neighbouring_links(const kinematics::Chain& chain,
                                                    const std::vector<bool>& has_shape);

}  // namespace kinship::collision
