#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "proto/types/digest.hpp"
#include "server/catalog/pending_fit.hpp"

namespace kinship::catalog {

/// The pending fits under way, at most one per distribution. Not shared between threads.
class PendingFits {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Map = std::unordered_map<Digest, PendingFit>;

  PendingFit* find(const Digest& id);
  /// The pending fit of this id, made if there is none. \return the pending fit, and whether it is
  /// new.
  std::pair<PendingFit&, bool> open(const Digest& id, const fitting::DistributionKey& key);
  void close(const Digest& id) { pending_.erase(id); }
  /// Adds an answer for every waiter, and closes all.
  void close_all(const SharedReply& reply, Answers& answers);

  /// Adds an answer for waiters whose deadline has passed; closes pending fits that are idle then.
  void answer_expired(TimePoint now, const SharedReply& reply, Answers& answers);

  std::size_t waiters() const;
  std::size_t waiters_of(std::string_view client) const;
  /// Number of pending fits that a client asked for first and that are not idle.
  std::size_t fits_of(std::string_view client) const;
  /// Adds the waiters and fits of each client.
  void add_to(std::map<std::string, ClientHolds>& holds) const;
  /// The earliest deadline of a waiter, or due look-up.
  std::optional<TimePoint> next_deadline() const;

  Map::iterator begin() { return pending_.begin(); }
  Map::iterator end() { return pending_.end(); }

 private:
  Map pending_;
};

}  // namespace kinship::catalog
