#pragma once

#include <string>

#include "client/link/client.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// Renames and removes registered robots. Each error is NotFound, InvalidInput (refused), Internal
/// (failed) with the server's message, or Unavailable.
namespace kinship::link {

/// Gives a robot another label; its old label becomes free. A client that registers the robot under
/// its old label receives Known.
/// \param robot  its label or the beginning of its digest.
/// \return the robot as it is then.
Result<RobotSummary> rename_robot(Client& server, const std::string& robot,
                                  const std::string& label);

/// Removes a robot without confirmation: one without attempts is deleted; otherwise its paths are
/// retired and its attempts stay for the record. Its distributions are deleted, its label becomes
/// free. A client that reports for it registers it again.
/// \param robot  its label or the beginning of its digest.
Result<RobotRemoval> remove_robot(Client& server, const std::string& robot);

}  // namespace kinship::link
