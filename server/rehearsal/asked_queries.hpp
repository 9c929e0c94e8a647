#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "server/rehearsal/posed_query.hpp"
#include "server/rehearsal/recorded_query.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::rehearsal {

/// Asks for the goal of a request in scenes that other robots recorded: where one robot grasps,
/// another one's hand may not fit. Recorded queries that the robot cannot plan get that goal; where
/// no recorded goal is near it, copies of others do. At most 8, or 24 where robots stand
/// elsewhere for each query: then the robot stands about where it stands today, as widely spread as
/// those that recorded.
/// \param T_task_goal  of the transfer frame.
/// \param T_task_base  where the robot stands today.
void ask_in_recorded_scenes(const Eigen::Isometry3d& T_task_goal, const runtime::Robot& robot,
                            const Eigen::Isometry3d& T_task_base, const Starts& starts,
                            std::vector<RecordedQuery>& queries);

}  // namespace kinship::rehearsal
