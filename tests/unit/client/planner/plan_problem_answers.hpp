#pragma once

#include "client/guided/plan_problem.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/planning/path_vertices.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

/// How the tests of plan_problem ask, and what they look for in an answer.
namespace kinship::guided::plan_problem_test {

using test::planar_robot;
using test::wall_problem;

inline bool never() { return false; }

inline PlannedProblem planned(const Problem& problem, const PlanSettings& settings = {},
                              const QueryGuidance& query = {}) {
  return plan_problem(planar_robot(), problem, query, settings, never);
}

inline Eigen::Isometry3d placement_of(const Problem& problem) {
  return problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
}

/// Collisions along a path that is straight between its waypoints.
/// \param step  between the configurations looked at, joint units
inline int collisions_along(const Eigen::MatrixXd& waypoints, const Problem& problem,
                            double step = PlanSettings().resolution) {
  const Eigen::MatrixXd path = planning::densified(waypoints, step);
  const PlannedRobot robot = planar_robot();
  collision::CollisionWorld world(robot.solids, {placement_of(problem), problem.scene, {}, {}});
  int collisions = 0;
  for (Eigen::Index i = 0; i < path.cols(); ++i)
    if (world.collides(path.col(i)))
      ++collisions;
  return collisions;
}

inline Guidance guidance_towards(const Eigen::VectorXd& q) {
  Guidance guidance;
  guidance.distribution_id.emplace().bytes[3] = 9;
  guidance.revision = 5;
  guidance.mixture =
      Mixture(Eigen::VectorXd::Ones(1), q, {0.25 * Eigen::MatrixXd::Identity(q.size(), q.size())});
  guidance.guided_fraction = 0.9;
  return guidance;
}

}  // namespace kinship::guided::plan_problem_test
