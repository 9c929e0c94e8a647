#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "client/guided/attempt_record.hpp"
#include "client/guided/planner_choice.hpp"
#include "client/guided/query_sampler.hpp"
#include "client/guided/scene_record.hpp"
#include "proto/types/number_text.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/planning/kept_orientation.hpp"

namespace kinship::c_library {
namespace {

TaskSpaceRegion read_region(const kinship_region& given) {
  TaskSpaceRegion region;
  region.T_task_region = read_pose(given.T_task_region, "query->region->T_task_region");
  region.T_region_end = read_pose(given.T_region_end, "query->region->T_region_end");
  region.bounds.row(0) = Eigen::Map<const Eigen::RowVector<double, 6>>(given.lower);
  region.bounds.row(1) = Eigen::Map<const Eigen::RowVector<double, 6>>(given.upper);
  if (const auto fault = validate(region))
    throw Failure(invalid_input("query->region: " + *fault));
  return region;
}

Problem read_problem(const kinship_query& given, const kinematics::Chain& chain) {
  if (given.dof != static_cast<std::size_t>(chain.dof()))
    throw Failure(invalid_input("query->dof is " + std::to_string(given.dof) + ", must be " +
                                std::to_string(chain.dof()) + ", the joints of the robot"));
  Problem problem;
  if (given.surroundings != nullptr) {
    const kinship_surroundings around = read_structure(given.surroundings, "query->surroundings");
    collision::Surroundings read = read_surroundings(around, chain);
    if (around.T_task_base != nullptr)
      problem.T_task_base = read.T_task_base;
    problem.scene = std::move(read.scene);
    problem.attached = std::move(read.attached);
    problem.allowed_collisions = std::move(read.allowed_collisions);
  }
  problem.start = read_columns(given.start, chain.dof(), 1, "query->start");
  if (given.goal_count > 0) {
    problem.goal_configurations =
        read_columns(given.goals, chain.dof(), given.goal_count, "query->goals");
  } else {
    require(given.T_task_goal, "query->T_task_goal");
    problem.T_task_goal = read_pose(given.T_task_goal, "query->T_task_goal");
  }
  if (given.time_limit_s != 0) {
    if (!(given.time_limit_s > 0 && given.time_limit_s <= 1e6))
      throw Failure(invalid_input("query->time_limit_s is " + number_text(given.time_limit_s) +
                                  ", must be above 0, at most 1e6"));
    problem.time_limit_s = given.time_limit_s;
  }
  problem.seed = given.seed;
  if (given.region != nullptr)
    problem.constraint = read_region(read_structure(given.region, "query->region"));
  return problem;
}

/// \return missing if nothing guides the query. It borrows the handles.
std::optional<guided::Guidance> read_guidance(const kinship_query& given,
                                              const kinematics::Chain& chain) {
  if (given.distribution == nullptr && given.recall == nullptr)
    return std::nullopt;
  if (!(given.share >= 0 && given.share <= 1))
    throw Failure(
        invalid_input("query->share is " + number_text(given.share) + ", must be 0 to 1"));
  const auto refuse_other = [&](Eigen::Index dof, const char* name) {
    if (dof != chain.dof())
      throw Failure(invalid_input(std::string("query->") + name + " is of " + std::to_string(dof) +
                                  " joints, the robot has " + std::to_string(chain.dof())));
  };
  guided::Guidance guidance;
  guidance.guide = Guide::None;
  if (given.distribution != nullptr) {
    const Distribution& distribution = *given.distribution->value;
    refuse_other(distribution.mixture->dimension(), "distribution");
    guidance.distribution_id = distribution.id;
    guidance.revision = distribution.revision;
    guidance.mixture = distribution.mixture;
    guidance.guided_fraction =
        given.share > 0 ? given.share : distribution.advice.recommended_share;
    guidance.guide = Guide::Mixture;
    guidance.T_task_base = distribution.T_task_base.value_or(Eigen::Isometry3d::Identity());
  }
  if (given.recall != nullptr) {
    refuse_other(given.recall->guide.warper().chain().dof(), "recall");
    guidance.recall = {std::shared_ptr<const recall::RecallGuide>(), &given.recall->guide};
    guidance.guide = with_recall(guidance.guide);
    guidance.T_task_base = given.recall->T_task_base;
  }
  return guidance;
}

guided::PlanSettings read_settings(const kinship_planner& planner, const kinship_query& given) {
  guided::PlanSettings settings;
  settings.limit_slack = planner.limit_slack.value_or(settings.limit_slack);
  if (given.algorithm != nullptr)
    settings.planner = guided::parse_planner(given.algorithm).value_or_throw();
  return settings;
}

guided::QueryGuidance choose(const std::optional<guided::Guidance>& guidance,
                             const kinship_query& given) {
  if (!guidance)
    return {.why_not = "no guidance was given"};
  guided::QueryGuidance query{.guidance = &*guidance, .sampling_mode = SamplingMode::Guided};
  if (given.sampling == KINSHIP_CONTROL)
    query.sampling_mode = SamplingMode::Control;
  if (given.recall != nullptr) {
    const std::scoped_lock lock(given.recall->mutex);
    query.recall_trust = given.recall->trust.value();
  }
  return query;
}

bool is_recalled(const guided::PlannedProblem& planned) {
  return planned.result.found_by == FoundBy::Recalled;
}

}  // namespace
}  // namespace kinship::c_library

using namespace kinship::c_library;

kinship_code kinship_planner_create(const kinship_robot_file* file, kinship_planner** planner,
                                    size_t* dof) {
  return guarded([&] {
    require(planner, "planner");
    *planner = nullptr;
    const kinship::models::LoadedRobot robot = read_robot_file(read_structure(file, "file"));
    if (const auto error = kinship::geometry::find_faults(robot.chain, robot.shapes))
      return remember(*error);
    *planner = new kinship_planner(robot);
    if (dof != nullptr)
      *dof = static_cast<size_t>(robot.chain.dof());
    return KINSHIP_OK;
  });
}

kinship_code kinship_region_keep_orientation(const double* tolerances, int is_rotation_vector,
                                             kinship_region* region) {
  return guarded([&] {
    require(tolerances, "tolerances");
    kinship_region kept = read_structure(region, "region");
    const auto found = kinship::planning::keep_orientation(
        Eigen::Map<const Eigen::Vector3d>(tolerances), is_rotation_vector != 0);
    if (!found)
      return remember(found.error());
    for (Eigen::Index i = 0; i < 6; ++i) {
      kept.upper[i] = i < 3 ? HUGE_VAL : found->bounds[i - 3];
      kept.lower[i] = -kept.upper[i];
    }
    write_structure(kept, region, "region");
    return KINSHIP_OK;
  });
}

void kinship_planner_free(kinship_planner* planner) { delete planner; }

kinship_code kinship_plan_find(const kinship_planner* planner, const kinship_query* query,
                               kinship_plan** plan) {
  return guarded([&] {
    require(planner, "planner");
    require(plan, "plan");
    *plan = nullptr;
    const kinship_query given = read_structure(query, "query");
    const kinship::kinematics::Chain& chain = planner->robot->chain;
    kinship::Problem problem = read_problem(given, chain);
    const auto guidance = read_guidance(given, chain);
    const auto settings = read_settings(*planner, given);
    auto planned = kinship::guided::plan_problem(
        *planner->robot, problem, choose(guidance, given), settings,
        [&] { return given.stop != nullptr && given.stop(given.user) != 0; });
    if (!planned.interrupted && planned.result.not_planned == kinship::NotPlanned::Error)
      return remember(KINSHIP_INVALID_INPUT, planned.result.reason);
    if (given.recall != nullptr && planned.recall_expected > 0) {
      const std::scoped_lock lock(given.recall->mutex);
      given.recall->trust.add(planned.recall_expected, is_recalled(planned));
    }
    *plan = new kinship_plan{planner->robot, std::move(problem), settings, std::move(planned)};
    return KINSHIP_OK;
  });
}

void kinship_plan_free(kinship_plan* plan) { delete plan; }

kinship_code kinship_plan_describe(const kinship_plan* plan, kinship_plan_info* info) {
  return guarded([&] {
    require(plan, "plan");
    const kinship::ProblemResult& result = plan->planned.result;
    kinship_plan_info told{};
    told.is_solved = result.solved ? 1 : 0;
    told.is_recalled = is_recalled(plan->planned) ? 1 : 0;
    told.is_stopped = plan->planned.interrupted ? 1 : 0;
    told.dof = static_cast<size_t>(plan->robot->chain.dof());
    if (result.waypoints)
      told.waypoint_count = static_cast<size_t>(result.waypoints->cols());
    told.collision_checks = result.collision_checks + result.goal_checks + result.shortcut_checks;
    told.planning_time_s = result.planning_time_s;
    told.processor_time_s = result.processor_time_s;
    told.reason = plan->planned.interrupted ? "stopped" : result.reason.c_str();
    told.planner = result.planner.c_str();
    write_structure(told, info, "info");
    return KINSHIP_OK;
  });
}

kinship_code kinship_plan_copy(const kinship_plan* plan, double* waypoints) {
  return guarded([&] {
    require(plan, "plan");
    require(waypoints, "waypoints");
    const auto& path = plan->planned.result.waypoints;
    if (!path)
      return remember(KINSHIP_NOT_FOUND, "there is no path: " + plan->planned.result.reason);
    std::copy_n(path->data(), path->size(), waypoints);
    return KINSHIP_OK;
  });
}

kinship_code kinship_plan_report(kinship_client* client, const kinship_plan* plan, const char* task,
                                 const char* machine) {
  return guarded([&] {
    require(client, "client");
    require(plan, "plan");
    require(task, "task");
    if (plan->planned.interrupted || !plan->planned.attempted)
      return remember(
          KINSHIP_INVALID_INPUT,
          "nothing was planned: " + (plan->planned.interrupted ? std::string("it was stopped")
                                                               : plan->planned.result.reason));
    kinship::Attempt attempt = kinship::guided::make_attempt(
        {*plan->robot, text_or_empty(machine), task}, plan->problem, plan->planned, plan->settings);
    attempt.scene =
        kinship::guided::record_scene(plan->robot->chain, plan->problem).value_or_throw();
    client->line.report(attempt);
    return KINSHIP_OK;
  });
}
