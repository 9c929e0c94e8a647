#include "client/moveit/conversion.hpp"

#include "client/moveit/frames.hpp"
#include "client/moveit/geometry_messages.hpp"
#include "client/moveit/goals.hpp"
#include "client/moveit/objects.hpp"
#include "client/moveit/yaml_value.hpp"

namespace kinship::moveit {
namespace {

/// The message itself, where a service's answer or an action's goal was written around it.
YamlValue unwrapped(const YamlValue& document, std::initializer_list<const char*> members) {
  YamlValue value = document;
  for (const char* member : members)
    if (!value[member].is_missing())
      value = value[member];
  return value;
}

/// A base that moves (a virtual joint) has to be said as a placement.
void refuse_moved_base(const YamlValue& scene, const ConversionInput& input) {
  if (input.T_task_base)
    return;
  for (const YamlValue& transform :
       scene["robot_state"]["multi_dof_joint_state"]["transforms"].items())
    if (!read_pose(transform).isApprox(Eigen::Isometry3d::Identity()))
      transform.refuse(
          "a virtual joint moves the robot; say with --placement where its base stands");
}

Conversion convert(const ConversionInput& input, const kinematics::Chain& chain) {
  const YamlValue request =
      unwrapped(YamlValue::read(input.request), {"goal", "request", "motion_plan_request"});
  // Without a scene nothing is asked of one: members of a missing place are missing.
  const YamlValue scene = input.scene.empty() ? request["scene"]["none"]
                                              : unwrapped(YamlValue::read(input.scene), {"scene"});
  refuse_moved_base(scene, input);
  Conversion conversion;
  Problem& problem = conversion.problem;
  problem.name = input.name;
  problem.start = read_start(scene, request, chain);
  const Frames frames(chain, input.T_task_base, problem.start, scene);
  problem.T_task_base = frames.T_task_base();
  read_objects(scene, request, chain, frames, conversion);
  read_goals(request, chain, frames, conversion);
  if (const double limit_s = request["allowed_planning_time"].number_or(0); limit_s > 0)
    problem.time_limit_s = limit_s;
  return conversion;
}

}  // namespace

Result<Conversion> read_problem(const ConversionInput& input, const kinematics::Chain& chain) {
  try {
    return convert(input, chain);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace kinship::moveit
