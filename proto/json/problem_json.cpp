#include "proto/json/problem_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/json/name_pairs_json.hpp"
#include "proto/json/reader.hpp"
#include "proto/json/scene_json.hpp"
#include "proto/json/task_space_region_json.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {
namespace {

constexpr std::size_t kMaxAttached = 64;
constexpr double kMaxTimeLimit = 86400;  // s

void read_goal(const Reader& reader, Problem& problem) {
  reader.allow_only({"configurations", "pose"});
  const auto configurations = reader.find("configurations");
  const auto pose = reader.find("pose");
  if (configurations.has_value() == pose.has_value())
    reader.refuse("must have either configurations or pose");
  if (pose) {
    problem.T_task_goal = pose->pose();
    return;
  }
  problem.goal_configurations = configurations->columns(kMaxDof, kMaxWaypoints);
  if (problem.goal_configurations.cols() == 0)
    configurations->refuse("is empty");
  if (problem.goal_configurations.rows() != problem.start.size())
    configurations->refuse(std::to_string(problem.goal_configurations.rows()) +
                           " joints, start has " + std::to_string(problem.start.size()));
}

Problem read_problem(const Reader& reader) {
  reader.allow_only({"name", "T_task_base", "start", "goal", "scene", "attached",
                     "allowed_collisions", "constraint", "time_limit_s", "seed"});
  Problem problem;
  problem.name = reader.at("name").text(kMaxTaskBytes);
  if (const auto placement = reader.find("T_task_base"))
    problem.T_task_base = placement->pose();
  problem.start = reader.at("start").vector(kMaxDof);
  if (problem.start.size() == 0)
    reader.at("start").refuse("is empty");
  read_goal(reader.at("goal"), problem);
  if (const auto scene = reader.find("scene"))
    problem.scene = read_scene(*scene);
  if (const auto attached = reader.find("attached"))
    for (const Reader& object : attached->elements(kMaxAttached))
      problem.attached.push_back(read_attached(object));
  if (const auto allowed = reader.find("allowed_collisions"))
    problem.allowed_collisions = read_pairs(*allowed);
  if (const auto constraint = reader.find("constraint"))
    problem.constraint = read_region(*constraint);
  if (const auto limit = reader.find("time_limit_s"))
    problem.time_limit_s = limit->number(0, kMaxTimeLimit);
  if (const auto seed = reader.find("seed"))
    problem.seed = seed->count();
  return problem;
}

ProblemResult read_problem_result(const Reader& reader) {
  ProblemResult result;
  result.name = reader.at("name").text(kMaxTaskBytes);
  result.solved = reader.at("solved").boolean();
  result.collision_checks = reader.at("collision_checks").count();
  if (const auto checks = reader.find("goal_checks"))
    result.goal_checks = checks->count();
  if (const auto checks = reader.find("shortcut_checks"))
    result.shortcut_checks = checks->count();
  result.projections = reader.at("projections").count();
  result.planning_time_s = reader.at("planning_time_s").number(0);
  result.time_limit_s = reader.at("time_limit_s").number(0);
  if (const auto waypoints = reader.find("waypoints"))
    result.waypoints = waypoints->columns(kMaxDof, kMaxWaypoints);
  if (const auto guidance = reader.find("guidance")) {
    result.distribution_id = guidance->at("distribution_id").digest();
    result.distribution_revision = guidance->at("revision").count();
    result.share = guidance->at("share").number(0, 1);
    result.arm = result.share > 0 ? Arm::Guided : Arm::Control;
    if (const auto arm = guidance->find("arm"))
      result.arm = parse_arm(arm->text(kMaxWordBytes)).value_or_throw();
    if (const auto gate = guidance->find("gate_fired"))
      result.gate_fired = gate->boolean();
  }
  if (const auto reason = reader.find("guidance_reason"))
    result.guidance_reason = reason->text(kMaxMessageBytes);
  if (const auto planner = reader.find("planner"))
    result.planner = planner->text(kMaxPlannerBytes);
  if (const auto reason = reader.find("reason"))
    result.reason = reason->text(kMaxMessageBytes);
  return result;
}

}  // namespace

std::string to_json(const Problem& problem) {
  OrderedJson object;
  object["name"] = problem.name;
  object["T_task_base"] = pose_or_null(problem.T_task_base);
  object["start"] = list(problem.start);
  if (problem.T_task_goal)
    object["goal"]["pose"] = pose_list(*problem.T_task_goal);
  else
    object["goal"]["configurations"] = list_of_columns(problem.goal_configurations);
  object["scene"] = scene_object(problem.scene);
  OrderedJson attached = OrderedJson::array();
  for (const AttachedObject& each : problem.attached)
    attached.push_back(attached_object(each));
  object["attached"] = std::move(attached);
  object["allowed_collisions"] = pair_list(problem.allowed_collisions);
  object["constraint"] =
      problem.constraint ? region_object(*problem.constraint) : OrderedJson(nullptr);
  object["time_limit_s"] = problem.time_limit_s;
  object["seed"] = problem.seed;
  return write(object);
}

Result<Problem> problem_from_json(std::string_view text) {
  return read_document(text, "problem", read_problem);
}

std::string to_json(const ProblemResult& result) {
  OrderedJson object;
  object["name"] = result.name;
  object["solved"] = result.solved;
  object["collision_checks"] = result.collision_checks;
  object["goal_checks"] = result.goal_checks;
  object["shortcut_checks"] = result.shortcut_checks;
  object["projections"] = result.projections;
  object["planning_time_s"] = result.planning_time_s;
  object["time_limit_s"] = result.time_limit_s;
  object["waypoints"] =
      result.waypoints ? list_of_columns(*result.waypoints) : OrderedJson(nullptr);
  object["guidance"] = nullptr;
  if (result.distribution_id)
    object["guidance"] = {{"distribution_id", result.distribution_id->hex()},
                          {"revision", result.distribution_revision},
                          {"share", result.share},
                          {"arm", to_text(result.arm)},
                          {"gate_fired", result.gate_fired}};
  object["guidance_reason"] = result.guidance_reason;
  object["planner"] = result.planner;
  object["reason"] = result.reason;
  return write(object);
}

Result<ProblemResult> problem_result_from_json(std::string_view text) {
  return read_document(text, "problem result", read_problem_result);
}

}  // namespace kinship::json
