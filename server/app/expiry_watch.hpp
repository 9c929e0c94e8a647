#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "proto/security/credentials.hpp"

namespace kinship::app {

/// Warns once a day, as long as beat() is called, that credentials expire soon or have expired: a
/// server may be up for longer than they are valid. Not to be shared between threads.
class ExpiryWatch {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::hours kInterval{24};

  /// \param credentials  empty: no warnings.
  /// \param wall_time    returns the time of now, UTC.
  /// \param warn         called with the text of a warning.
  ExpiryWatch(std::optional<security::Credentials> credentials,
              std::function<std::chrono::sys_seconds()> wall_time,
              std::function<void(std::string_view)> warn)
      : credentials_(std::move(credentials)),
        wall_time_(std::move(wall_time)),
        warn_(std::move(warn)) {}

  /// Warns if a warning is due, at the first call too. \return when to call again; TimePoint::max()
  /// without credentials.
  TimePoint beat(TimePoint now);

 private:
  const std::optional<security::Credentials> credentials_;
  const std::function<std::chrono::sys_seconds()> wall_time_;
  const std::function<void(std::string_view)> warn_;
  std::optional<TimePoint> next_;
};

}  // namespace kinship::app
