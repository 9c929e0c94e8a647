#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>

#include "proto/types/problem.hpp"

namespace kinship::plan {

/// Tells people how far a run is: one line that is written over on a terminal, otherwise a line
/// for every tenth of the problems.
class Progress {
 public:
  Progress(std::ostream& stream, bool terminal, std::size_t total)
      : stream_(stream), terminal_(terminal), total_(total) {}

  void add(const ProblemResult& result);

  /// Ends the line and writes the sums.
  void finish();

 private:
  std::ostream& stream_;
  bool terminal_;
  std::size_t total_;
  std::size_t done_ = 0;
  std::size_t solved_ = 0;
  std::uint64_t checks_ = 0;
  double planning_time_s_ = 0;
};

}  // namespace kinship::plan
