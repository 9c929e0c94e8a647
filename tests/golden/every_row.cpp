// Of every_value.hpp: the rows that verbs list, and what planners read and answer.

#include <limits>

#include "tests/golden/every_value.hpp"

namespace kinship::test {
namespace {

Problem problem_without_goal(Distinct& next) {
  Problem problem;
  problem.name = next.name("problem");
  problem.T_task_base = next.pose();
  problem.start = next.matrix(kJoints, 1);
  problem.scene.objects = {
      {next.name("box"), BoxShape{{next.share(), next.share(), next.share()}}, next.pose()},
      {next.name("cylinder"), CylinderShape{next.share(), next.share()}, next.pose()},
      {next.name("sphere"), SphereShape{next.share()}},
      {next.name("capsule"), CapsuleShape{next.share(), next.share()}, next.pose()}};
  problem.scene.objects[2].T_task_object.translation() << 1, 2, 3;
  problem.scene.meshes = {{next.name("mesh"), {next.text("file"), {1, 2, -3}}, next.pose()}};
  problem.scene.clouds = {{next.name("cloud"), {next.text("file"), next.share()}, next.pose()}};
  problem.attached = {{next.name("held"),
                       next.name("link"),
                       CylinderShape{next.share(), next.share()},
                       next.pose(),
                       {next.name("touch"), next.name("touch")}},
                      {next.name("held"),
                       next.name("link"),
                       {},
                       next.pose(),
                       {},
                       Mesh{next.text("file"), {4, 5, 6}}}};
  problem.allowed_collisions = {{next.name("first"), next.name("second")}};
  problem.constraint = TaskSpaceRegion{next.pose(), next.pose()};
  problem.constraint->bounds.row(0) << -1, -2, -std::numeric_limits<double>::infinity(), -0.5,
      -0.25, -0.125;
  problem.constraint->bounds.row(1) << 1.5, 2.5, std::numeric_limits<double>::infinity(), 0.75,
      0.375, 0.1875;
  problem.time_limit_s = next.real();
  problem.seed = next.count();
  return problem;
}

}  // namespace

Explanation every_explanation() {
  Distinct next(1300);
  Explanation explanation;
  explanation.distribution = every_distribution();
  explanation.distribution.mixture.reset();
  explanation.experience = {next.described<Explanation::Now>(), next.described<Explanation::Now>()};
  explanation.behind = true;
  explanation.next_fit = next.text("next fit");
  explanation.rehearsal = every_rehearsal();
  return explanation;
}

Problem every_problem() {
  Distinct next(1800);
  Problem problem = problem_without_goal(next);
  problem.goal_configurations = next.matrix(kJoints, 2);
  return problem;
}

Problem every_pose_problem() {
  Distinct next(1900);
  Problem problem = problem_without_goal(next);
  problem.T_task_goal = next.pose();
  problem.T_task_base.reset();
  problem.constraint.reset();
  return problem;
}

Problem every_problem_from_pose() {
  Problem problem = every_pose_problem();
  Distinct next(1950);
  problem.start.resize(0);
  problem.T_task_start = next.pose();
  return problem;
}

ProblemResult every_problem_result() {
  Distinct next(2000);
  ProblemResult result;
  result.name = next.name("problem");
  result.solved = true;
  result.collision_checks = next.count();
  result.goal_checks = next.count();
  result.shortcut_checks = next.count();
  result.projections = next.count();
  result.planning_time_s = next.real();
  result.time_limit_s = next.real();
  result.start = Eigen::VectorXd::LinSpaced(kJoints, 0.25, 0.5);
  result.not_planned = NotPlanned::StartOffConstraint;
  result.waypoints = next.matrix(kJoints, 3);
  result.distribution_id = next.id<Digest>();
  result.distribution_revision = next.count();
  result.sampling_mode = SamplingMode::Control;
  result.share = next.share() / 2;
  result.gate_fired = true;
  result.proven = true;
  result.path_length = 3.5;
  result.hand_length_m = 1.75;
  result.least_clearance_m = 0.0625;
  result.refuted_edges = 3;
  result.track_share = 0.25;
  result.experience_revision = 12;
  result.tracks_followed = 3;
  result.recall_tries = 5;
  result.processor_time_s = 0.125;
  result.guide = Guide::RetreatWays;
  result.found_by = FoundBy::Track;
  result.reason = next.text("reason");
  result.planner = next.text("planner");
  result.guidance_reason = next.text("reason");
  return result;
}

InverseAnswer every_inverse_answer() {
  Distinct next(2100);
  InverseAnswer answer;
  answer.solver = next.text("solver");
  answer.solutions = next.matrix(kJoints, 2);
  answer.reason = next.text("reason");
  answer.time_us = next.real();
  return answer;
}

RobotCheck every_robot_check() {
  Distinct next(2200);
  RobotCheck check;
  check.robot = next.id<Digest>();
  check.base_link = next.name("base");
  check.tip_link = next.name("tip");
  check.joints = {next.described<CheckedJoint>(), next.described<CheckedJoint>()};
  check.structure = next.text("structure");
  check.solver = next.text("solver");
  check.poses = next.count();
  check.poses_without_solution = next.count();
  check.solutions_per_pose = next.real();
  check.time_per_pose_us = next.real();
  check.links = {next.described<CheckedLink>()};
  check.reach_m = next.real();
  check.transfer_distance_m = next.real();
  return check;
}

}  // namespace kinship::test
