#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

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

/// Where a robot begins what others recorded.
struct Starts {
  Eigen::VectorXd usual = {};  ///< dof, joint units; another size: not known
  bool are_recorded = false;   ///< with the hand where the others had theirs, not at the usual one
};

/// Of free configurations with the hand at a recorded start.
enum class Branch {
  Usual,  ///< nearest to the usual start; where that is not known, to the middle of the joints
  Drawn   ///< where starts are the recorded ones, any one; equal for equal queries
};

/// Whether a robot begins as the others did: their hands begin at many places, and its usual start
/// is among these, or not known.
/// \param T_task_base  of the robot's base in the task frame.
/// \param usual        see Starts.
Starts find_starts(const kinematics::Chain& chain, const Eigen::Isometry3d& T_task_base,
                   const std::vector<RecordedQuery>& recorded, const Eigen::VectorXd& usual);

/// Start and goals in the recorded scene. The robot of the recorded path stands and starts as it
/// did. Another robot starts as `starts` says; where its usual start is not free, with the hand at
/// the recorded start. Goals are all free configurations with the transfer frame at the recorded
/// goal, up to 20. Pairs that always touch, such as a base and its table, may touch.
/// \param T_task_base  of the robot's base in the task frame, for what another robot recorded.
/// \return nothing if the robot has no start or no goal.
std::optional<PosedQuery> pose_query(const runtime::Robot& robot,
                                     const Eigen::Isometry3d& T_task_base,
                                     const RecordedQuery& recorded, const Starts& starts = {},
                                     Branch branch = Branch::Usual);

}  // namespace kinship::rehearsal
