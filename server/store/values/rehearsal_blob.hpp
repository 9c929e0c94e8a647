#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/store/store.hpp"

namespace kinship::store {

/// Version of these bytes and of the code that makes rehearsals and libraries. Raised when earlier
/// ones should not be used any more.
inline constexpr int kRehearsalVersion = 1;

/// A rehearsal as a blob, without the members that are columns: id, robot, task and made_ms.
std::vector<std::uint8_t> encode_rehearsal(const StoredRehearsal& rehearsal);

/// Sets the other members.
/// \return false if the blob is no result of encode_rehearsal, or one of another version.
bool decode_rehearsal(std::span<const std::uint8_t> blob, StoredRehearsal& rehearsal);

}  // namespace kinship::store
