#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/distribution.hpp"

namespace kinship::store {

/// A distribution as a blob, without its revision, its store epoch and the current cost of the
/// sampling modes (advice.guided, advice.control, advice.recent, advice.guided_share). Numbers keep
/// every bit, except that a Mixture normalises its weights again and a pose is stored as 7 numbers.
std::vector<std::uint8_t> encode_distribution(const Distribution& distribution);

/// \return empty if the blob is no result of encode_distribution.
std::optional<Distribution> decode_distribution(std::span<const std::uint8_t> blob);

}  // namespace kinship::store
