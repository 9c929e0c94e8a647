#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "robots/recall/library_maker.hpp"
#include "server/rehearsal/posed_query.hpp"
#include "server/rehearsal/recorded_query.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::rehearsal {

/// The recorded queries of which a library of paths to recall is made for a robot: those with a
/// scene, that it can start and end. Where the robot begins as the others
/// did, their queries twice, from two branches, if there is room for them.
/// \param T_task_base  of the robot's base in the task frame, for what other robots recorded.
std::vector<recall::PosedQuery> recall_queries(const runtime::Robot& robot,
                                               const Eigen::Isometry3d& T_task_base,
                                               const std::vector<RecordedQuery>& recorded,
                                               const Starts& starts);

}  // namespace kinship::rehearsal
