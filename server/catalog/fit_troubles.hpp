#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"

namespace kinship::catalog {

/// The reason why the last fit of a distribution made nothing with unchanged experience: no memory,
/// no thread, a store that cannot be read. It may succeed later.
struct FitTrouble {
  FetchStatus status = FetchStatus::Busy;  ///< of the reply: Busy, or Refused with what to change
  std::string message;
  int failures = 0;  ///< in a row
  std::chrono::steady_clock::time_point next_try;
};

/// Failed fits, by distribution: each is tried again after a pause that doubles with every failure.
/// Their number is bounded; the one due first is forgotten first. Not shared between threads.
class FitTroubles {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds kFirstRetry{1};
  static constexpr std::chrono::seconds kLastRetry{300};
  static constexpr std::size_t kMaxTroubles = 1024;

  const FitTrouble& add(const Digest& id, TimePoint now, FetchStatus status,
                        const std::string& message);
  /// The fit succeeded, or is to be tried at once.
  void erase(const Digest& id) { troubles_.erase(id); }

  /// Null: the fit may be tried now.
  const FitTrouble* find(const Digest& id, TimePoint now) const;
  /// The last trouble, whether the fit may be tried again or not; null: none.
  const FitTrouble* last(const Digest& id) const;

 private:
  std::map<Digest, FitTrouble> troubles_;
};

}  // namespace kinship::catalog
