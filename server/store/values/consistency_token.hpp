#pragma once

#include <cstdint>
#include <optional>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::store {

/// A point of a store's history: the run that wrote it, and the position of that run by then. The
/// engine defines the position.
struct LogPosition {
  Uuid run;
  std::uint64_t position = 0;

  bool operator==(const LogPosition&) const = default;
};

/// The key of a new store: 244 random bits.
Digest random_key();

/// A point as a consistency token for clients, with a signature (HMAC-SHA-256 of epoch, run and
/// position, its first 16 bytes) that only this store can make: a client cannot forge a point at
/// which the store never was.
/// \param key  of the store, secret.
ConsistencyToken sign(const Digest& key, const Uuid& epoch, const LogPosition& point);

/// \return empty unless the token was signed with this key in this epoch.
std::optional<LogPosition> verify(const Digest& key, const Uuid& epoch,
                                  const ConsistencyToken& token);

}  // namespace kinship::store
