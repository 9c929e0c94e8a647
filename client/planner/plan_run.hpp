#pragma once

#include <functional>
#include <iosfwd>

#include "client/planner/plan_options.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::planner {

/// Input and outputs of a run.
struct RunStreams {
  std::istream& problems;
  std::ostream& results;
  std::ostream& messages;            ///< for people
  std::ostream* searches = nullptr;  ///< the growth of each search; null: not written
  bool messages_on_terminal = false;
  bool results_for_people = false;  ///< lines of text instead of JSON
};

/// How a run ended.
struct RunSummary {
  int exit_code = kDone;
  bool is_complete = false;  ///< every line has its result, whatever the exit code
};

/// Reads the problems, fetches guidance once per placement, plans each problem and writes its
/// result in input order, reports the attempts.
/// \param stop  called often; true ends the run cleanly: finished problems are written and
///              reported.
/// \return      fails if the server refuses the robot (nothing is planned if it does so at once),
/// if
///              no problem fits the robot or could be read, or a report could not be kept.
/// \throws Failure if the robot cannot be read or the results cannot be written.
RunSummary run_plan(const PlanOptions& options, const RunStreams& streams,
                    const std::function<bool()>& stop);

}  // namespace kinship::planner
