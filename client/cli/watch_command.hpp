#pragma once

#include <chrono>
#include <csignal>
#include <deque>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/types/summaries.hpp"

namespace kinship::cli {

struct WatchOptions {
  std::string task;   ///< only events of this task; empty: all
  std::string robot;  ///< only events of this robot: label or digest prefix; empty: all
  bool json = false;  ///< one document per line, and nothing else on `out`
  /// Interval of the lines with rates and the benefit of guidance; 0: on a terminal in a status
  /// line, elsewhere never.
  std::chrono::seconds every{0};
  std::string place = {};  ///< "127.0.0.1, domain 0": the server's address
};

/// Blocks SIGINT and SIGTERM in this thread and those it starts from now on, so that
/// watch_events() takes them: to be called before there is a Client.
sigset_t block_end_signals();

/// `watch`: prints the server's events until SIGINT or SIGTERM; on `err`, that there is no server,
/// and each one that comes and goes. A robot name that cannot be looked up is used literally, with
/// a message on `err`: the robot may be registered later.
/// \param until  the result of block_end_signals().
int watch_events(link::Client& server, const WatchOptions& options, const sigset_t& until,
                 std::ostream& out, std::ostream& err);

/// A server's recent rates, from repeated readings of its counters.
class ServerRates {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit ServerRates(std::chrono::milliseconds window) : window_(window) {}

  /// Lower counters mean a restart of the server: the window begins with them.
  void add(const ServerStatus& status, TimePoint now);

  /// "reports 12.3/s, fetches 4.0/s, fits 0.2/s; queued 3 reports, 1 fit"; empty before there are
  /// two readings.
  std::string text() const;

 private:
  struct Reading {
    TimePoint time;
    ServerStatus status;
  };
  const std::chrono::milliseconds window_;
  std::deque<Reading> readings_;  // the first one is as old as the window, or the oldest
};

/// The cost of guided and uniform planning of a robot on a task so far, as checks per solution:
/// "ur10e on box_to_shelf: 487 checks a solution guided, 852 uniform: 1.75 times fewer"; empty
/// while one of the two sampling modes has no solution. Guidance includes the retreat, so this is
/// not the worth of experience.
std::string guidance_text(const std::string& task, const TaskRobotSummary& robot);

}  // namespace kinship::cli
