#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/summaries.hpp"

/// What became of a task over time, from what was reported of it.
namespace kinship::plots {

/// Quartiles of collision checks; an unsolved attempt is dearer than every solved one. Missing:
/// dearer than what anybody knows.
struct CheckQuartiles {
  std::optional<double> lower, median, upper;

  bool operator==(const CheckQuartiles&) const = default;
};

/// \param solved    the checks of those that were solved, in any order.
/// \param unsolved  how many there are besides; together one at least.
CheckQuartiles check_quartiles(std::vector<double> solved, std::uint64_t unsolved);

/// The attempts of one sampling mode in one stretch of time. Those that could not be planned at all
/// are none.
struct ModeCounts {
  std::uint64_t attempts = 0;
  std::uint64_t solved = 0;
  CheckQuartiles checks;
};

/// One stretch of time of one robot.
struct RobotBin {
  std::size_t bin = 0;                   ///< its number from the beginning of the history
  std::uint64_t attempts = 0;            ///< of all modes, up to its end
  std::uint64_t paths = 0;               ///< of them solved
  std::array<ModeCounts, 3> modes = {};  ///< by SamplingMode, in the bin alone
};

/// What is believed at one time of the ratio of what typical queries cost, uniform / guided.
struct Benefit {
  std::int64_t time_ms = 0;
  double ratio = 1, low = 1, high = 1;    ///< median and 90 % interval
  std::uint64_t guided = 0, control = 0;  ///< attempts up to then
};

struct RobotHistory {
  Digest robot;
  std::string label;
  std::uint64_t attempts = 0, solved = 0, unsolved = 0;
  std::uint64_t not_planned = 0;     ///< start or goal could not be: of `attempts`, nothing else
  std::vector<RobotBin> bins;        ///< those in which there were attempts
  std::string planner;               ///< of the attempts that are compared
  std::uint64_t other_planners = 0;  ///< judged attempts of others, which are not
  std::vector<Benefit> benefit;      ///< empty: too few attempts to compare
};

/// A revision of a distribution that attempts of the task were planned with, or that is kept now.
struct Revision {
  Digest id;
  std::uint64_t revision = 0;
  std::string label;           ///< of its robot
  std::uint64_t attempts = 0;  ///< that name it
  std::int64_t first_ms = 0;   ///< when the first of them came; 0: none did
  std::int64_t fitted_ms = 0;  ///< when it was made; 0: nobody knows any more
};

struct TaskHistory {
  std::string task;
  std::int64_t from_ms = 0;  ///< beginning of the first bin, Unix time
  std::int64_t bin_ms = 0;   ///< length of a bin
  std::size_t bins = 0;
  std::vector<RobotHistory> robots;  ///< by label
  std::vector<Revision> revisions;   ///< oldest first
};

/// So many attempts of either mode are compared, as for the server's advice; fewer say nothing.
inline constexpr std::uint64_t kMinCompared = 10;

inline constexpr std::size_t kMaxBins = 60;

/// A second, or the shortest of the lengths people count in of which kMaxBins reach from the first
/// to the last time.
std::int64_t bin_length_ms(std::int64_t first_ms, std::int64_t last_ms);

/// \param attempts       of one task, as they arrived; one at least.
/// \param distributions  of the task, as they are kept now.
/// \throws std::invalid_argument without an attempt.
TaskHistory history_of(const std::string& task, std::vector<AttemptSummary> attempts,
                       const std::vector<DistributionSummary>& distributions);

}  // namespace kinship::plots
