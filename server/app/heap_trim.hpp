#pragma once

#include <chrono>
#include <cstddef>

namespace kinship::app {

/// Gives the memory of many participants that have gone back to the system: the C library keeps
/// freed pieces between others.
class HeapTrim {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// \param participants  that are known now.
  /// \return when to be called again.
  TimePoint beat(TimePoint now, std::size_t participants);

 private:
  TimePoint next_{};
  std::size_t most_ = 0;  // participants since the last time
};

}  // namespace kinship::app
