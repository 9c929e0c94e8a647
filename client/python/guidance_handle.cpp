#include "client/python/guidance_handle.hpp"

#include <string>

#include "client/guided/problem_mismatch.hpp"
#include "proto/evidence/machine_speed.hpp"
#include "proto/types/enum_text.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/recall/recall.hpp"

namespace kinship::python {
namespace {

/// \throws Failure(InvalidInput) as GuidanceHandle::recall().
void require_recallable(const kinematics::Chain& chain, const Problem& problem) {
  const std::string name = "problem '" + problem.name + "': ";
  if (const auto mismatch = guided::find_mismatch(chain, problem))
    throw Failure(invalid_input(name + mismatch->text));
  if (problem.T_task_start)
    throw Failure(invalid_input(name + "recall begins at a configuration, not at a pose"));
  if (problem.constraint)
    throw Failure(invalid_input(name + "recalled paths keep no constraint"));
}

/// \param problem  is recallable.
recall::Query query_of(const recall::RecallGuide& guide, const Problem& problem) {
  const kinematics::Chain& chain = guide.warper().chain();
  recall::Query query;
  query.T_task_base = problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
  query.bounds = planning::planning_bounds(chain, problem.start);
  query.start = problem.start;
  query.goals.resize(chain.dof(), 0);
  if (problem.T_task_goal)
    query.T_base_goal = query.T_task_base.inverse() * *problem.T_task_goal;
  else
    query.goals = planning::all_turned_into(query.bounds, chain, problem.goal_configurations);
  query.T_task_anchors = recall::find_anchors(guide.library().anchors, problem.scene.objects);
  return query;
}

}  // namespace

std::shared_ptr<GuidanceHandle> GuidanceHandle::of_distribution(
    const SampledDistribution& distribution) {
  guided::GuidanceOptions wanted;
  wanted.task = distribution.value()->task;
  wanted.robot = distribution.value()->robot;
  wanted.dof = distribution.mixture().dimension();
  wanted.guide = Guide::Mixture;
  wanted.sampling.control_fraction = 0;
  const auto fetch = [&](const FetchRequest&) -> Result<FetchReply> {
    FetchReply reply;
    reply.status = FetchStatus::Ready;
    reply.distribution = *distribution.value();
    return reply;
  };
  guided::GuidanceAnswer answer =
      guided::fetch_guidance(fetch, wanted, distribution.value()->T_task_base);
  if (!answer.guidance)
    throw Failure(ErrorCode::InvalidInput, answer.message);
  return std::make_shared<GuidanceHandle>(wanted.robot, std::move(answer), std::nullopt,
                                          distribution.value()->T_task_base);
}

std::shared_ptr<GuidanceHandle> GuidanceHandle::of_robot(const Robot& robot, Guide guide) {
  if (needs_experience(guide))
    throw Failure(
        ErrorCode::InvalidInput,
        "guide '" + std::string(to_text(guide)) +
            "' needs the experience of a task: Client.guidance(); retreat and none do not");
  guided::GuidanceOptions wanted;
  wanted.robot = robot.digest();
  wanted.chain = robot.chain();
  wanted.guide = guide;
  wanted.sampling.control_fraction = 0;
  return std::make_shared<GuidanceHandle>(
      wanted.robot, guided::fetch_guidance({}, wanted, std::nullopt), robot.chain());
}

double GuidanceHandle::guided_part() const {
  const std::scoped_lock lock(mutex_);
  return answer_.sampling->guided_part();
}

SamplingMode GuidanceHandle::choose(const Problem& problem) const {
  const std::scoped_lock lock(mutex_);
  return answer_.sampling->choose(guided::sampling_mode_seed(problem));
}

double GuidanceHandle::recall_trust() const {
  const std::scoped_lock lock(mutex_);
  return recall_trust_.value();
}

std::optional<Eigen::MatrixXd> GuidanceHandle::recall(const Problem& problem,
                                                      const planning::IsFree& is_free,
                                                      double step) {
  if (chain_)
    require_recallable(*chain_, problem);
  if (!guidance().recall)
    return std::nullopt;
  recall::RecallSummary summary =
      recall::recall(*guidance().recall, query_of(*guidance().recall, problem), is_free,
                     {.step = step, .trust = recall_trust()});
  const std::scoped_lock lock(mutex_);
  recall_trust_.add(summary.expected, summary.waypoints && !summary.is_straight_line);
  if (!summary.waypoints)
    return std::nullopt;
  return planning::sparse_vertices(*summary.waypoints, step);
}

void GuidanceHandle::add(const guided::PlannedProblem& planned) {
  const std::scoped_lock lock(mutex_);
  recall_trust_.add(planned.recall_expected, planned.result.found_by == FoundBy::Recalled);
  answer_.sampling->add(planned.result.sampling_mode, planned.outcome,
                        planned.result.collision_checks,
                        planned.result.processor_time_s * evidence::machine_speed());
}

}  // namespace kinship::python
