#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>

#include "robots/collision/collision_world.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/planning/region_constraint.hpp"
#include "server/rehearsal/recorded_query.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::rehearsal {

/// A recorded query, posed to one robot at its placement.
struct PosedQuery {
  planning::TrackQuery query;  ///< `without` is the path that once answered it
  collision::Surroundings surroundings;
  std::unique_ptr<collision::CollisionWorld> world;
  std::optional<planning::RegionConstraint> constraint;
};

/// Start and goals in the recorded scene. The robot of the recorded path stands and starts as it
/// did. Another robot starts at its usual start or, where that is not free, at the free
/// configuration with the transfer frame at the recorded start that is nearest to the middle of its
/// joints' ranges. Goals are all free configurations with the transfer frame at the recorded goal,
/// up to 20. Pairs that always touch, such as a base and its table, may touch.
/// \param T_task_base  of the robot's base in the task frame, for what another robot recorded.
/// \param usual_start  dof, joint units; another size: there is none.
/// \return nothing if it has no start or no goal.
std::optional<PosedQuery> pose_query(const runtime::Robot& robot,
                                     const Eigen::Isometry3d& T_task_base,
                                     const RecordedQuery& recorded,
                                     const Eigen::VectorXd& usual_start = {});

}  // namespace kinship::rehearsal
