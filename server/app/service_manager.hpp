#pragma once

#include <chrono>
#include <optional>
#include <string_view>

namespace kinship::app {

/// Sends the state of the service, e.g. "READY=1", to systemd or another manager that set
/// NOTIFY_SOCKET. \return false if NOTIFY_SOCKET is not set or the message could not be sent;
/// nothing depends on it.
/// Source: sd_notify(3), section "Notes", which describes the protocol.
bool notify_service_manager(std::string_view state);

/// Sends "WATCHDOG=1" to the service manager twice per watchdog timeout (WatchdogSec of systemd),
/// as long as beat() is called. Not to be shared between threads.
class Watchdog {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// Reads WATCHDOG_USEC from the environment if it is meant for this process (WATCHDOG_PID).
  /// Source: sd_watchdog_enabled(3), which describes the variables.
  Watchdog();

  /// Sends the message if it is due. \return when to call again; TimePoint::max() without a
  /// watchdog.
  TimePoint beat(TimePoint now);

 private:
  std::optional<std::chrono::microseconds> interval_;  // between two messages
  TimePoint next_{};
};

}  // namespace kinship::app
