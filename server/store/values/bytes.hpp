#pragma once

#include <cstdint>
#include <span>

namespace kinship::store {

/// Bytes of somebody else's.
using Bytes = std::span<const std::uint8_t>;

}  // namespace kinship::store
