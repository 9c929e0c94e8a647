#pragma once

#include <vector>

#include "client/experiments/page/page_data.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

/// A robot in one configuration as capsules around its collision shapes: capsules and spheres as
/// they are, a cylinder or box as a capsule along its longest side.
/// \param q  dof, joint units.
std::vector<Bone> bones_of(const models::LoadedRobot& robot, const Eigen::Isometry3d& T_task_base,
                           const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace kinship::experiments
