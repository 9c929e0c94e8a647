#pragma once

#include <iosfwd>
#include <string>

#include "client/experiments/studies/fleet.hpp"

namespace kinship::experiments {

/// Answers queries of one robot with an experience planner of OMPL, line by line.
/// \param kind  "lightning" or "thunder", with a colon the range of its RRTConnects in joint units;
///              without it OMPL's choice.
/// \param in    first what it learns, {"problem", "waypoints": [[q], ...]} a line; then an empty
///              line; then a problem a line.
/// \param out   first {"learned": text}; then of each problem {"recall", "scratch"}, each
/// {"solved",
///              "checks", "cpu_s", "length"}: what the halves of the planner cost by themselves,
///              from experience and in the second thread from scratch.
/// \throws Failure(InvalidInput) for another kind or line, Failure(NotFound) without a path.
void answer_as_peer(const Study& study, const StudyMember& member, const std::string& kind,
                    std::istream& in, std::ostream& out);

}  // namespace kinship::experiments
