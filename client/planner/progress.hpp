#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "client/guided/unplanned_problems.hpp"
#include "proto/types/problem.hpp"

namespace kinship::planner {

/// Shows a run's progress: on a terminal one line that is overwritten, otherwise a line for every
/// tenth of the problems.
class Progress {
 public:
  Progress(std::ostream& stream, bool terminal, std::size_t total)
      : stream_(stream), terminal_(terminal), total_(total) {}

  /// \param attempted  false: the problem does not fit the robot, or could not be read.
  void add(const ProblemResult& result, bool attempted);

  /// Ends the line and writes the sums, of the problems that could be planned; below them the first
  /// problems that could not, and what the paths of each sampling mode measure.
  void finish();

  /// Whether there were problems, and none of them fits the robot.
  bool nothing_attempted() const noexcept { return done_ > 0 && attempted_ == 0; }

 private:
  /// Values of each path.
  struct Measures {
    std::vector<double> lengths, hands_m, clearances_m;
  };

  void write_measures() const;

  std::ostream& stream_;
  bool terminal_;
  std::size_t total_;
  std::size_t done_ = 0, attempted_ = 0, solved_ = 0;
  std::size_t guided_ = 0, control_ = 0, uniform_ = 0;  // searches by sampling mode
  std::size_t gated_ = 0;                               // of the guided ones
  std::array<Measures, 3> measures_;                    // by SamplingMode
  guided::UnplannedProblems unplanned_;
  std::uint64_t checks_ = 0;    // of searches
  double planning_time_s_ = 0;  // of searches
};

/// A result as one line for people, without line end: outcome, cost, and its guidance or why there
/// was none.
std::string result_text(const ProblemResult& result);

}  // namespace kinship::planner
