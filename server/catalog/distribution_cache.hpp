#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "server/catalog/adviser.hpp"
#include "server/catalog/experience_versions.hpp"
#include "server/catalog/pending_fit.hpp"
#include "server/fitting/last_used.hpp"

namespace kinship::catalog {

/// The replies requested last, bounded by number and size; the least recently used one is dropped
/// first. Not shared between threads.
class DistributionCache {
 public:
  struct Limits {
    std::size_t entries = 1024;
    std::size_t bytes = std::size_t{128} << 20U;
  };

  struct Entry {
    AdvisedReply reply;  ///< Ready or Failed, with its distribution
    /// Version of the task when the distribution was last compared with its experience, and whether
    /// it was behind.
    ExperienceVersion version = {};
    bool behind = false;
    std::chrono::steady_clock::time_point noted = {};  ///< when a use was last noted in the store
  };

  explicit DistributionCache(const Limits& limits) : limits_(limits) {}

  /// Replaces the entry of this id. An entry larger than the limit is kept alone.
  void put(const Digest& id, Entry entry);

  /// The entry, now the last one used; null if there is none. Valid until the next put.
  Entry* find(const Digest& id) { return replies_.find(id); }

  void erase(const Digest& id) { replies_.erase(id); }

  /// The ids of the distributions in memory for a robot.
  std::vector<Digest> of_robot(const Digest& robot) const;

  /// Gives a distribution other advice; does nothing if the entry holds another reply by now.
  void replace(const Digest& id, const SharedReply& before, const AdvisedReply& after);

  std::size_t size() const noexcept { return replies_.size(); }
  std::size_t bytes() const noexcept { return replies_.bytes(); }  ///< of the replies, about
  std::uint64_t dropped() const noexcept { return dropped_; }      ///< for want of room, so far

 private:
  Limits limits_;
  fitting::LastUsed<Entry> replies_;
  std::uint64_t dropped_ = 0;
};

}  // namespace kinship::catalog
