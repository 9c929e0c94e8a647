#pragma once

#include <string>

#include "client/link/client.hpp"
#include "proto/types/result.hpp"
#include "proto/types/summaries.hpp"

/// Registered robots that get another label, or are taken out. Each error is NotFound, InvalidInput
/// (refused), Internal (failed) with the server's message, or Unavailable.
namespace kinship::link {

/// Gives a robot another label; the one it had is free from then on. Clients that register the
/// robot under its old label are answered Known.
/// \param robot  its label or the beginning of its digest.
/// \return the robot as it is then.
Result<RobotSummary> rename_robot(Client& server, const std::string& robot,
                                  const std::string& label);

/// Takes a robot out, without asking: one without attempts is deleted; the paths of another are
/// retired, its attempts stay for the record. Its distributions are gone, its label is free. A
/// client that reports for it registers it again. \param robot  its label or the beginning of its
/// digest.
Result<RobotRemoval> remove_robot(Client& server, const std::string& robot);

}  // namespace kinship::link
