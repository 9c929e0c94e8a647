#pragma once

#include <cstdint>
#include <span>

namespace kinship::store {

/// Borrowed bytes.
using Bytes = std::span<const std::uint8_t>;

}  // namespace kinship::store
