#include "proto/json/problem_json.hpp"

#include "proto/json/fields.hpp"
#include "proto/json/name_pairs_json.hpp"
#include "proto/json/result_fields.hpp"
#include "proto/json/scene_json.hpp"
#include "proto/json/task_space_region_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {
namespace {

constexpr std::size_t kMaxAttached = 64;
constexpr double kMaxTimeLimit = 86400;  // s

void read_start(const Reader& reader, Problem& problem) {
  if (reader.is_object()) {
    reader.allow_only({"pose"});
    problem.T_task_start = reader.at("pose").pose();
    return;
  }
  problem.start = reader.vector(kMaxDof);
  if (problem.start.size() == 0)
    reader.refuse("is empty");
}

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
  if (!problem.T_task_start && problem.goal_configurations.rows() != problem.start.size())
    configurations->refuse(std::to_string(problem.goal_configurations.rows()) +
                           " joints, start has " + std::to_string(problem.start.size()));
}

Problem read_problem(const Reader& reader) {
  reader.allow_only({"format", "name", "T_task_base", "start", "goal", "scene", "attached",
                     "allowed_collisions", "constraint", "time_limit_s", "seed"});
  Problem problem;
  problem.name = reader.at("name").text(kMaxTaskBytes);
  if (const auto placement = reader.find("T_task_base"))
    problem.T_task_base = placement->pose();
  read_start(reader.at("start"), problem);
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
  read_members(reader, kEffort, result);
  if (const auto start = reader.find("start"))
    result.start = start->vector(kMaxDof);
  if (const auto waypoints = reader.find("waypoints"))
    result.waypoints = waypoints->columns(kMaxDof, kMaxWaypoints);
  if (const auto guidance = reader.find("guidance"))
    read_members(*guidance, kGuidance, result);
  read_members(reader, kReasons, result);
  return result;
}

}  // namespace

std::string to_json(const Problem& problem) {
  OrderedJson object;
  object["name"] = problem.name;
  object["T_task_base"] = pose_or_null(problem.T_task_base);
  if (problem.T_task_start)
    object["start"]["pose"] = pose_list(*problem.T_task_start);
  else
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
  return write(kProblemFormat, object);
}

Result<Problem> problem_from_json(std::string_view text) {
  return read_document(text, "problem", kProblemFormat, read_problem);
}

std::string to_json(const ProblemResult& result) {
  OrderedJson object;
  add_members(result, kEffort, object);
  object["start"] = result.start ? list(*result.start) : OrderedJson(nullptr);
  object["waypoints"] =
      result.waypoints ? list_of_columns(*result.waypoints) : OrderedJson(nullptr);
  object["guidance"] = nullptr;
  if (result.distribution_id || result.sampling_mode != SamplingMode::Uniform)
    add_members(result, kGuidance, object["guidance"]);
  add_members(result, kReasons, object);
  return write(kResultFormat, object);
}

Result<ProblemResult> problem_result_from_json(std::string_view text) {
  return read_document(text, "problem result", kResultFormat, read_problem_result);
}

}  // namespace kinship::json
