#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "proto/types/distribution.hpp"

namespace kinship::store {

/// A distribution as a blob, all but its revision, its store epoch and what the arms of attempts
/// cost (advice.guided, advice.control, advice.recent, advice.guided_share), which are of the
/// moment. Numbers keep every bit, except that a Mixture normalises its weights again and a pose
/// passes through its 7 numbers.
std::vector<std::uint8_t> encode_distribution(const Distribution& distribution);

/// \return empty if the blob is not what encode_distribution makes.
std::optional<Distribution> decode_distribution(std::span<const std::uint8_t> blob);

}  // namespace kinship::store
