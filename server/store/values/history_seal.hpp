#pragma once

#include <cstdint>
#include <optional>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::store {

/// A point of a store's history: the run that wrote it, and the position of that run by then. The
/// engine defines the position.
struct HistoryPoint {
  Uuid run;
  std::uint64_t position = 0;

  bool operator==(const HistoryPoint&) const = default;
};

/// The key of a new store: 244 random bits.
Digest random_key();

/// A point as a consistency token for clients, with a seal (HMAC-SHA-256 of epoch, run and
/// position, its first 16 bytes) that only this store can make: a client cannot forge a point at
/// which the store never was.
/// \param key  of the store, secret.
HistoryMark seal(const Digest& key, const Uuid& epoch, const HistoryPoint& point);

/// \return empty unless the mark was sealed with this key in this epoch.
std::optional<HistoryPoint> open_seal(const Digest& key, const Uuid& epoch,
                                      const HistoryMark& mark);

}  // namespace kinship::store
