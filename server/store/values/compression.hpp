#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace kinship::store {

/// \return the bytes compressed by zstd at its fastest level, or nothing if that is not smaller.
std::optional<std::vector<std::uint8_t>> compress(std::span<const std::uint8_t> bytes);

/// \return nothing unless `bytes` is the result of compress() for `size` bytes.
std::optional<std::vector<std::uint8_t>> decompress(std::span<const std::uint8_t> bytes,
                                                    std::size_t size);

}  // namespace kinship::store
