#pragma once

#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

namespace kinship::link {

/// The robot that the server knows by a name, in one request.
/// \param name  a label, or the beginning of a digest (four digits or more).
/// \return      NotFound, InvalidInput (more than one robot) or Unavailable if there is none.
Result<RobotSummary> find_robot(Client& client, const std::string& name);

/// The digests of robots that the server knows by names: one request per name, each up to the
/// client's timeout.
/// \param names  labels or beginnings of digests (four digits or more).
/// \return       ascending and distinct, as Selection wants them; or NotFound, InvalidInput (more
///               than one robot) or Unavailable for the first name without a robot.
Result<std::vector<Digest>> resolve_robots(Client& client, const std::vector<std::string>& names);

}  // namespace kinship::link
