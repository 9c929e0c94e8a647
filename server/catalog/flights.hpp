#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <unordered_map>
#include <utility>

#include "proto/types/digest.hpp"
#include "server/catalog/flight.hpp"

namespace kinship::catalog {

/// The flights under way, at most one per distribution. Not shared between threads.
class Flights {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Map = std::unordered_map<Digest, Flight>;

  Flight* find(const Digest& id);
  /// The flight of this id, made if there is none. \return it, and whether it is new.
  std::pair<Flight&, bool> open(const Digest& id, const fitting::DistributionKey& key);
  void close(const Digest& id) { flights_.erase(id); }
  /// Adds an answer for everybody who waits, and closes all.
  void close_all(const SharedReply& reply, Answers& answers);

  /// Adds an answer for those whose deadline has passed; closes what is idle then.
  void answer_expired(TimePoint now, const SharedReply& reply, Answers& answers);

  std::size_t waiters() const;
  /// When somebody's deadline passes, or a look is due.
  std::optional<TimePoint> next_deadline() const;

  Map::iterator begin() { return flights_.begin(); }
  Map::iterator end() { return flights_.end(); }

 private:
  Map flights_;
};

}  // namespace kinship::catalog
