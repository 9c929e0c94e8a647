#pragma once

#include <functional>
#include <iosfwd>

#include "client/plan/plan_options.hpp"

namespace kinship::plan {

/// What a run reads and writes.
struct RunStreams {
  std::istream& problems;
  std::ostream& results;
  std::ostream& messages;  ///< for people
  bool messages_on_terminal = false;
};

/// Exit codes, as every program of Kinship has them.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kWrongUsage = 2;
inline constexpr int kNotFound = 3;
inline constexpr int kNoServer = 4;

/// Reads the problems, fetches guidance once per placement, plans each problem and writes its
/// result in input order, reports the attempts.
/// \param stop  asked often; true ends the run cleanly: what is planned is written and reported.
/// \return      an exit code.
/// \throws Failure if the robot cannot be read or the results cannot be written.
int run_plan(const PlanOptions& options, const RunStreams& streams,
             const std::function<bool()>& stop);

}  // namespace kinship::plan
