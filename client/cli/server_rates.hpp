#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/summaries.hpp"

namespace kinship::cli {

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
/// while one of the two sampling modes has no solution.
std::string guidance_text(const std::string& task, const TaskRobotSummary& robot);

}  // namespace kinship::cli
