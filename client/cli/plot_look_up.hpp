#pragma once

#include <string>

#include "client/link/client.hpp"
#include "pages/plots/look_up.hpp"
#include "proto/types/result.hpp"

namespace kinship::cli {

struct KnownRobot {
  RobotSummary summary;
  RobotDescription description;
};

/// \param name  a label, or the beginning of a digest.
/// \throws Failure for rows that cannot be read.
Result<KnownRobot> find_known_robot(link::Client& server, const std::string& name);

/// Asks a server, once for each path, robot or distribution.
/// \param server  outlives it.
plots::LookUp look_up_of(link::Client& server);

}  // namespace kinship::cli
