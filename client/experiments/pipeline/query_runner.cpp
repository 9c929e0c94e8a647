#include "client/experiments/pipeline/query_runner.hpp"

#include "client/experiments/pipeline/oracle.hpp"
#include "client/experiments/pipeline/parallel_for.hpp"
#include "proto/types/failure.hpp"
#include "robots/planning/path_vertices.hpp"

namespace kinship::experiments {
namespace {

QueryResult answer(const StudyMember& member, const Cell& cell, const Problem& problem,
                   QueryKey key) {
  guided::QueryGuidance query;
  if (cell.guidance)
    query = {.guidance = &*cell.guidance, .sampling_mode = SamplingMode::Guided};
  std::optional<guided::Guidance> oracle;
  if (cell.oracle_deviation)
    oracle = oracle_guidance(member, problem, cell.settings, *cell.oracle_deviation);
  if (oracle)
    query = {.guidance = &*oracle, .sampling_mode = SamplingMode::Guided};
  const guided::PlannedProblem planned =
      guided::plan_problem(member.planned, problem, query, cell.settings, [] { return false; });
  if (!planned.attempted)
    throw Failure(ErrorCode::Internal, problem.name + ": " + planned.result.reason);
  const ProblemResult& result = planned.result;
  return {.key = std::move(key),
          .distribution = cell.guidance ? result.distribution_id : std::nullopt,
          .solved = result.solved,
          .checks = result.collision_checks,
          .goal_checks = result.goal_checks,
          .projections = result.projections,
          .cpu_s = result.planning_time_s,
          .length = result.waypoints ? planning::path_length(*result.waypoints) : 0,
          .gate_fired = result.gate_fired,
          .guided_share = result.share,
          .track_share = result.track_share,
          .found_by = result.found_by,
          .guide = query.guidance != nullptr ? std::optional(result.guide) : std::nullopt};
}

/// All queries of one robot and instance.
void answer_instance(const StudyMember& member, const std::vector<const Cell*>& cells,
                     std::uint32_t index, const QueryPlan& plan, QueryLog& log) {
  Problem problem = read_instance(member, plan.seed, index);
  const std::uint64_t own_seed = problem.seed;
  for (std::uint32_t seed = 0; seed < plan.seeds; ++seed) {
    problem.seed = own_seed + seed;
    for (const Cell* const cell : cells) {
      const QueryKey key{member.label(), cell->name, problem.name, seed};
      std::optional<Digest> distribution;
      if (cell->guidance)
        distribution = cell->guidance->distribution_id;
      if (!log.has(key, distribution))
        log.add(answer(member, *cell, problem, key));
      if (plan.answered)
        plan.answered();
    }
  }
}

}  // namespace

bool guide_by(std::optional<Guide> guide, const StudyMember& member, const Fetched& fetched,
              double share, Cell& cell) {
  if (!guide)
    guide = fetched.rehearsal ? fetched.rehearsal->guide : Guide::All;
  if ((has_mixture(*guide) && !fetched.distribution.mixture) ||
      (has_ways(*guide) && fetched.experience.paths.empty()))
    return false;
  guided::Guidance& guidance = cell.guidance.emplace();
  guidance.guide = *guide;
  guidance.guided_fraction = share;
  guidance.distribution_id = fetched.distribution.id;
  guidance.revision = fetched.distribution.revision;
  guidance.mixture = fetched.distribution.mixture;
  guidance.experience = std::make_shared<planning::ExperienceGuide>(
      member.robot.chain, has_ways(*guide) ? fetched.experience : TaskExperience{});
  return true;
}

void run_queries(const std::vector<StudyMember>& fleet, const std::vector<Cell>& cells,
                 const QueryPlan& plan, QueryLog& log) {
  std::vector<std::vector<const Cell*>> cells_of(fleet.size());
  for (const Cell& cell : cells)
    cells_of.at(cell.robot).push_back(&cell);
  for (std::size_t robot = 0; robot < fleet.size(); ++robot) {
    if (cells_of[robot].empty())
      continue;
    parallel_for(plan.threads, plan.instances, [&](std::size_t i) {
      answer_instance(fleet[robot], cells_of[robot], static_cast<std::uint32_t>(i), plan, log);
    });
  }
}

}  // namespace kinship::experiments
