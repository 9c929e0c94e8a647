#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"

namespace kinship::catalog {

/// Why the last fit of a distribution made nothing, although its experience is as it was: no
/// memory, no thread, a store that cannot be read. It may go well later.
struct FitTrouble {
  FetchStatus status = FetchStatus::Busy;  ///< for who asks: Busy, or Refused with what to change
  std::string message;
  int failures = 0;  ///< in a row
  std::chrono::steady_clock::time_point next_try;
};

/// Such fits, by distribution: each is tried again after a while that doubles with every failure. A
/// bounded number; the one that is due first is forgotten first. Not shared between threads.
class FitTroubles {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds kFirstRetry{1};
  static constexpr std::chrono::seconds kLastRetry{300};
  static constexpr std::size_t kMaxTroubles = 1024;

  const FitTrouble& add(const Digest& id, TimePoint now, FetchStatus status,
                        const std::string& message);
  /// The fit went well, or is to be tried at once.
  void erase(const Digest& id) { troubles_.erase(id); }

  /// Null: it may be tried now.
  const FitTrouble* find(const Digest& id, TimePoint now) const;
  /// The last one, whether it may be tried again or not; null: there was none.
  const FitTrouble* last(const Digest& id) const;

 private:
  std::map<Digest, FitTrouble> troubles_;
};

}  // namespace kinship::catalog
