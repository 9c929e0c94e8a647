#pragma once

#include <optional>

#include "proto/types/task_experience.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::fitting {

/// The poses of the transfer frame along a stored path: up to kExperiencePoses poses in the task
/// frame, at equal parts of the length in joint space, first and last waypoint among them. A base
/// without a placement stands at the origin of the task.
/// \return nothing if the path does not fit the robot, has no length, or leaves the range of
///         coordinates of a pose.
std::optional<PosePath> pose_path(const store::StoredPath& stored, const runtime::Robot& robot);

}  // namespace kinship::fitting
