#include "client/moveit/conversion.hpp"

#include <algorithm>

#include "client/moveit/frames.hpp"
#include "client/moveit/geometry_messages.hpp"
#include "client/moveit/goals.hpp"
#include "client/moveit/message_members.hpp"
#include "client/moveit/objects.hpp"
#include "client/moveit/scene_text.hpp"
#include "client/moveit/yaml_value.hpp"
#include "proto/types/nearest_name.hpp"

namespace kinship::moveit {
namespace {

/// The message itself, where a service's answer or an action's goal was written around it.
YamlValue unwrapped(const YamlValue& document, const std::vector<std::string>& members) {
  static const std::vector<std::string> kBeside = {"error_code", "goal_id", "header",
                                                   "planning_options"};
  YamlValue value = document;
  for (const std::string& member : members) {
    if (value[member].is_missing())
      continue;
    for (const auto& [name, place] : value.members())
      if (name != member && std::ranges::count(kBeside, name) == 0)
        place.refuse("'" + name + "' is not known beside '" + member + "'" +
                     suggestion(name, kBeside));
    const YamlValue difference = value["planning_options"]["planning_scene_diff"];
    if (const YamlValue objects = difference["world"]["collision_objects"];
        !objects.items().empty())
      objects.refuse("a change to the scene; ask /get_planning_scene for the whole one");
    value = value[member];
  }
  return value;
}

/// A scene lists the objects around the robot, or says that there are none.
YamlValue checked_scene(const YamlValue& document) {
  YamlValue scene = unwrapped(document, {"scene"});
  check_members(scene, "PlanningScene");
  const YamlValue objects = scene["world"]["collision_objects"];
  if (objects.is_missing())
    objects.refuse("is missing; an empty scene says 'world: {collision_objects: []}'");
  return scene;
}

YamlValue checked_request(const YamlValue& document) {
  YamlValue request = unwrapped(document, {"goal", "request", "motion_plan_request"});
  check_members(request, "MotionPlanRequest");
  return request;
}

/// Documents in YAML, or a scene as RViz exports it.
std::vector<YamlValue> read_scenes(const std::filesystem::path& file) {
  std::vector<YamlValue> scenes;
  if (const auto exported = read_scene_text(file))
    scenes.push_back(YamlValue::of_document(*exported, file));
  else
    scenes = YamlValue::read_all(file);
  for (YamlValue& scene : scenes)
    scene = checked_scene(scene);
  return scenes;
}

void refuse_difference(const YamlValue& scene) {
  if (!scene["is_diff"].is_missing() && scene["is_diff"].flag())
    scene["is_diff"].refuse(
        "a change to another scene, which says not all that is there; ask /get_planning_scene for "
        "the whole one, or say false if this is all");
}

/// Members that a problem does not use, but a path may be judged by.
void note_unread(const YamlValue& request, std::vector<std::string>& left_out) {
  const auto note = [&](const char* member, const std::string& why) {
    const YamlValue value = request[member];
    if (!value.is_missing() && !value.text().empty())
      left_out.push_back(std::string(member) + " '" + value.text() + "': " + why);
  };
  note("group_name", "the robot's chain says which joints move");
  note("pipeline_id", "kinship-plan --planner says which planner");
  note("planner_id", "kinship-plan --planner says which planner");
  const YamlValue workspace = request["workspace_parameters"];
  if (!read_vector(workspace["min_corner"]).isZero() ||
      !read_vector(workspace["max_corner"]).isZero())
    left_out.emplace_back("workspace_parameters: it bounds a base that moves, not the arm");
  for (const char* member :
       {"max_velocity_scaling_factor", "max_acceleration_scaling_factor", "max_cartesian_speed"})
    if (const double value = request[member].number_or(0); value != 0 && value != 1)
      left_out.push_back(std::string(member) + ": a path has no times");
  if (!request["reference_trajectories"].items().empty())
    left_out.emplace_back("reference_trajectories");
}

Conversion convert(const YamlValue& scene, const YamlValue& request, const ConversionInput& input,
                   const kinematics::Chain& chain) {
  refuse_difference(scene);
  Conversion conversion;
  Problem& problem = conversion.problem;
  problem.start = read_start(scene, request, chain, conversion.left_out);
  const Frames frames(chain, input.T_task_base, problem.start, scene, request);
  problem.T_task_base = frames.T_task_base();
  read_objects(scene, request, chain, frames, conversion);
  read_goals(request, chain, frames, conversion);
  note_unread(request, conversion.left_out);
  if (const double limit_s = request["allowed_planning_time"].number_or(0); limit_s > 0)
    problem.time_limit_s = limit_s;
  return conversion;
}

std::vector<Conversion> convert_all(const ConversionInput& input, const kinematics::Chain& chain) {
  std::vector<YamlValue> requests = YamlValue::read_all(input.request);
  if (requests.empty())
    throw Failure(ErrorCode::InvalidInput, "'" + input.request.string() + "' holds no request");
  for (YamlValue& request : requests)
    request = checked_request(request);
  // Without a scene nothing is asked of one: members of a missing place are missing.
  std::vector<YamlValue> scenes = {requests.front()["scene"]["none"]};
  if (!input.scene.empty())
    scenes = read_scenes(input.scene);
  if (scenes.size() != 1 && scenes.size() != requests.size())
    throw Failure(ErrorCode::InvalidInput, "'" + input.scene.string() + "' holds " +
                                               std::to_string(scenes.size()) + " scenes for " +
                                               std::to_string(requests.size()) +
                                               " requests; one, or as many as requests");
  std::vector<Conversion> conversions;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const YamlValue& scene = scenes[scenes.size() == 1 ? 0 : i];
    conversions.push_back(convert(scene, requests[i], input, chain));
    conversions.back().problem.name =
        input.name + (requests.size() == 1 ? "" : "-" + std::to_string(i + 1));
  }
  return conversions;
}

}  // namespace

Result<std::vector<Conversion>> read_problems(const ConversionInput& input,
                                              const kinematics::Chain& chain) {
  try {
    return convert_all(input, chain);
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace kinship::moveit
