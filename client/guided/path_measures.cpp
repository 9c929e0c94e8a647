#include "client/guided/path_measures.hpp"

#include "robots/collision/collision_world.hpp"
#include "robots/collision/edge_prover.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::guided {

void measure_path(const PlannedRobot& robot, const Problem& problem, ProblemResult& result) {
  if (!result.waypoints)
    return;
  result.path_length = planning::path_length(*result.waypoints);
  result.hand_length_m = planning::hand_length_m(robot.chain, *result.waypoints);
  collision::CollisionWorld world(
      robot.solids, {problem.T_task_base.value_or(Eigen::Isometry3d::Identity()), problem.scene,
                     problem.attached, problem.allowed_collisions});
  result.least_clearance_m = collision::EdgeProver(world).least_clearance_m(
      planning::densified(*result.waypoints, planning::kMeasuredStep));
}

}  // namespace kinship::guided
