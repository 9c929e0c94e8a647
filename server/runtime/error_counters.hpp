#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/summaries.hpp"
#include "server/runtime/clock.hpp"

namespace kinship::runtime {

/// Kinds of errors for a client; kTroubleNames has their names.
enum class Trouble : std::uint8_t {
  ReportRefused,    ///< an attempt breaks a rule; final
  ReportTryAgain,   ///< the store cannot take it, or too much waits
  ReportUnknown,    ///< an attempt of a robot that is not registered
  ReportQuota,      ///< one client has too many unanswered attempts
  RobotRefused,     ///< a registration breaks a rule
  RobotUnanswered,  ///< a registration for which the store, memory or the queue had no room
  RobotUnreadable,  ///< a stored robot that cannot be read any more
  FetchRefused,     ///< a fetch breaks a rule
  FetchBusy,        ///< too many wait, or the server stops
  FetchQuota,       ///< one client has too many leases, waiting fetches or fits
  FitMemory,        ///< a fit would exceed the memory limit
  FitEnded,         ///< a fit ended for want of memory, threads or the store; tried again later
  AdminRefused,     ///< an admin request without the right to it
  AdminFailed,      ///< an admin request that the store or the queue could not serve
  ClientQuota,      ///< one client is over a quota of any kind
  NoMemory,         ///< something was put off because the system had no memory for it
};

inline constexpr std::array<std::string_view, 16> kTroubleNames = {"report refused",
                                                                   "report to be sent again",
                                                                   "report of an unknown robot",
                                                                   "report over quota",
                                                                   "robot refused",
                                                                   "robot not answered",
                                                                   "robot unreadable",
                                                                   "fetch refused",
                                                                   "fetch busy",
                                                                   "fetch over quota",
                                                                   "fit over the memory limit",
                                                                   "fit to be tried again",
                                                                   "admin verb refused",
                                                                   "admin verb failed",
                                                                   "client over quota",
                                                                   "out of memory"};

/// Counts troubles by kind and logs the first of each burst: an event that many clients repeat
/// every second is one line, and a number. Bounded by the number of kinds. May be shared between
/// threads; the log is called without the lock.
class ErrorCounters {
 public:
  /// A burst ends when its kind was quiet for this long.
  static constexpr std::chrono::seconds kQuiet{60};

  /// \param clock  outlives it.
  /// \param log    a line for people.
  ErrorCounters(const Clock& clock, std::function<void(std::string_view)> log)
      : clock_(clock), log_(std::move(log)) {}

  /// \param detail  text of the last one; cut to kMaxMessageBytes.
  void add(Trouble what, std::string_view detail, std::uint64_t count = 1);

  /// Kinds that have happened, in the order of the enumeration.
  std::vector<TroubleCount> counts() const;

 private:
  struct Entry {
    std::uint64_t count = 0;
    std::uint64_t logged_at = 0;  // count when a line was written
    std::string last;
    std::int64_t last_ms = 0;
    std::chrono::steady_clock::time_point last_time;
  };

  const Clock& clock_;
  const std::function<void(std::string_view)> log_;
  mutable std::mutex mutex_;  // guards entries_
  std::array<Entry, kTroubleNames.size()> entries_;
};

}  // namespace kinship::runtime
