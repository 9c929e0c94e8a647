#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/problem.hpp"
#include "proto/types/result.hpp"
#include "robots/kinematics/chain.hpp"

/// Commands about one attempt, solved or not. Each returns an exit code.
namespace kinship::cli {

/// The problem of an attempt that has a search record, to be planned again: its query, scene,
/// constraint, seed and time limit. What was held is attached to the tip link. Pairs that may touch
/// are left out if the scene or the robot lacks a body.
/// \param chain  of the attempt's robot.
/// \return InvalidInput if the attempt has no record, or no start or goal in it.
Result<Problem> problem_of(const Attempt& attempt, const kinematics::Chain& chain);

struct AttemptExportOptions {
  std::string id;                ///< a report UUID
  std::filesystem::path output;  ///< empty: standard output
};

/// `attempts export`: a problem file of one line for kinship-plan.
int export_attempt(link::Client& server, const AttemptExportOptions& options, std::ostream& out,
                   std::ostream& err);

}  // namespace kinship::cli
