#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/summaries.hpp"

namespace kinship::cli {

/// How busy a server was of late, from its counters as they were read now and then.
class ServerRates {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit ServerRates(std::chrono::milliseconds window) : window_(window) {}

  /// Counters that fell are those of a server that was started anew: the window begins with them.
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

/// What guidance of a robot on a task costs or brings so far, both arms' checks per solution:
/// "ur10e on box_to_shelf: 487 checks a solution guided, 852 uniform: 1.75 times fewer"; empty
/// while one of the two arms has no solution.
std::string guidance_text(const std::string& task, const TaskRobotSummary& robot);

}  // namespace kinship::cli
