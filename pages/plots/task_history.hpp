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

/// The history of a task, from its reports.
namespace kinship::plots {

/// Quartiles of collision checks; an unsolved attempt counts as costlier than every solved one.
/// Missing: costlier than every solved attempt.
struct CheckQuartiles {
  std::optional<double> lower, median, upper;

  bool operator==(const CheckQuartiles&) const = default;
};

/// \param solved    the checks of solved attempts, in any order.
/// \param unsolved  number of unsolved ones; together one at least.
CheckQuartiles check_quartiles(std::vector<double> solved, std::uint64_t unsolved);

/// The attempts of one sampling mode in one stretch of time. Attempts that could not be planned at
/// all do not count.
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

/// Estimate at one time of the cost ratio of typical queries, uniform / guided.
struct Benefit {
  std::int64_t time_ms = 0;
  double ratio = 1, low = 1, high = 1;    ///< median and 90 % interval
  std::uint64_t guided = 0, control = 0;  ///< attempts up to then
};

struct RobotHistory {
  Digest robot;
  std::string label;
  std::uint64_t attempts = 0, solved = 0, unsolved = 0;
  std::uint64_t not_planned = 0;     ///< only in `attempts`: start or goal was impossible
  std::vector<RobotBin> bins;        ///< bins with attempts
  std::string planner;               ///< of the attempts that are compared
  std::uint64_t other_planners = 0;  ///< judged attempts of other planners, not compared
  std::vector<Benefit> benefit;      ///< empty: too few attempts to compare
};

/// A revision of a distribution that attempts of the task used, or that the server keeps now.
struct Revision {
  Digest id;
  std::uint64_t revision = 0;
  std::string label;           ///< of its robot
  std::uint64_t attempts = 0;  ///< that name it
  std::int64_t first_ms = 0;   ///< time of the first of them; 0: none
  std::int64_t fitted_ms = 0;  ///< time of its fit; 0: no longer known
};

struct TaskHistory {
  std::string task;
  std::int64_t from_ms = 0;  ///< beginning of the first bin, Unix time
  std::int64_t bin_ms = 0;   ///< length of a bin
  std::size_t bins = 0;
  std::vector<RobotHistory> robots;  ///< by label
  std::vector<Revision> revisions;   ///< oldest first
};

/// Fewest attempts of either mode for a comparison, as for the server's advice.
inline constexpr std::uint64_t kMinCompared = 10;

inline constexpr std::size_t kMaxBins = 60;

/// A second, or the shortest customary length of which kMaxBins reach from the first to the last
/// time.
std::int64_t bin_length_ms(std::int64_t first_ms, std::int64_t last_ms);

/// \param attempts       of one task, as they arrived; one at least.
/// \param distributions  of the task, as kept now.
/// \throws std::invalid_argument without an attempt.
TaskHistory history_of(const std::string& task, std::vector<AttemptSummary> attempts,
                       const std::vector<DistributionSummary>& distributions);

/// Fills in the estimated worth of guidance at the end of each bin with judged attempts: of the
/// planner of most of them, because checks of two planners cannot be compared; of all profiles
/// together. Nothing before kMinCompared of either mode.
/// \param attempts  of one robot, by time.
void add_benefit(const std::vector<const AttemptSummary*>& attempts, const TaskHistory& history,
                 RobotHistory& robot);

}  // namespace kinship::plots
