#pragma once

#include "robots/kinematics/chain.hpp"

namespace kinship::test {

/// What a chain is made of, to make another one like it.
inline kinematics::ChainParts parts_of(const kinematics::Chain& chain) { return chain.parts(); }

}  // namespace kinship::test
