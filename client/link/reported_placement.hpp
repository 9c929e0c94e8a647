#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "client/link/admin_rows.hpp"
#include "client/link/client.hpp"
#include "proto/types/result.hpp"

namespace kinship::link {

/// Where a robot stood when it last reported a task.
struct ReportedPlacement {
  bool is_known = false;                         ///< whether it has reported the task
  std::optional<Eigen::Isometry3d> T_task_base;  ///< known and missing: reported without one
};

/// Asks the server, in two requests, and again if the attempt is dropped between them.
/// \param robot  its label.
/// \return unknown also if the server does not know the task or robot, or drops the attempt once
///         more; Unavailable, or InvalidInput if it does not tell this client of attempts.
Result<ReportedPlacement> reported_placement(const AskAdmin& ask, const std::string& task,
                                             const std::string& robot);
/// Each request up to the client's timeout.
Result<ReportedPlacement> reported_placement(Client& client, const std::string& task,
                                             const std::string& robot);

}  // namespace kinship::link
