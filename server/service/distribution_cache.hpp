#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <unordered_map>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "server/service/flight.hpp"

namespace kinship::service {

/// The replies that were asked for last, bounded by number and size; the one not used for longest
/// goes first. Not shared between threads.
class DistributionCache {
 public:
  struct Limits {
    std::size_t entries = 1024;
    std::size_t bytes = std::size_t{128} << 20U;
  };

  struct Entry {
    SharedReply reply;  ///< Ready or Failed, with its distribution
    /// Changes of the task's experience when the distribution was last compared with it, and
    /// whether it was found to be behind.
    std::uint64_t changes_seen = 0;
    bool behind = false;
  };

  explicit DistributionCache(const Limits& limits) : limits_(limits) {}

  /// Replaces the entry of this id. One that is larger than the limit is kept alone.
  void put(const Digest& id, Entry entry);

  /// The entry, now the last one used; null if there is none. Valid until the next put.
  Entry* find(const Digest& id);

  std::size_t size() const noexcept { return index_.size(); }
  std::size_t bytes() const noexcept { return bytes_; }  ///< of the mixtures, about

 private:
  struct Node {
    Digest id;
    Entry entry;
    std::size_t bytes = 0;
  };
  void drop(std::list<Node>::iterator node);

  Limits limits_;
  std::list<Node> nodes_;  // the one used last comes first
  std::unordered_map<Digest, std::list<Node>::iterator> index_;
  std::size_t bytes_ = 0;
};

}  // namespace kinship::service
