#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "proto/types/uuid.hpp"

namespace kinship {

/// How many first bytes of an epoch name the store: the same in all its epochs, also once it is
/// restored, repaired, copied or moved. The others are of the epoch alone.
inline constexpr std::size_t kStoreBytes = 6;

inline bool is_same_store(const Uuid& epoch, const Uuid& other) {
  return std::equal(epoch.bytes.begin(), epoch.bytes.begin() + kStoreBytes, other.bytes.begin());
}

/// \param before  an epoch of the store; zeros: it is a new one.
inline Uuid next_epoch(const Uuid& before) {
  Uuid next = Uuid::random();
  if (before != Uuid{})
    std::copy_n(before.bytes.begin(), kStoreBytes, next.bytes.begin());
  return next;
}

/// The store of an epoch, as its text begins, e.g. "ba62759c-d634".
inline std::string store_name(const Uuid& epoch) {
  return epoch.text().substr(0, 2 * kStoreBytes + 1);  // a dash is among the digits
}

}  // namespace kinship
