#pragma once

#include <cstddef>

namespace kinship::test {

/// Texts that urdfdom parsed in this process so far. A program that is linked with this function
/// parses through it.
std::size_t urdf_parses();

}  // namespace kinship::test
