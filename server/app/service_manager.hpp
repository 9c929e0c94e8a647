#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace kinship::app {

/// Tells systemd, or whoever else set NOTIFY_SOCKET, how the service is, e.g. "READY=1".
/// \return false if nobody asked or the message could not be sent; nothing depends on it.
/// Source: sd_notify(3), section "Notes", which describes the protocol.
bool notify_service_manager(std::string_view state);

/// "WATCHDOG=1" to the service manager, twice in the time after which it would take the service for
/// dead (WatchdogSec of systemd), as long as somebody calls. Not to be shared between threads.
class Watchdog {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// Of the environment: WATCHDOG_USEC, if it is meant for this process (WATCHDOG_PID). Source:
  /// sd_watchdog_enabled(3), which describes the variables.
  Watchdog();

  /// Tells it if it is time to. \return when to call again; the end of time if nobody asked.
  TimePoint beat(TimePoint now);

 private:
  std::optional<std::chrono::microseconds> interval_;  // between two messages
  TimePoint next_{};
};

}  // namespace kinship::app
