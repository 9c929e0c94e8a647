#include "client/guided/attempt_record.hpp"

#include <sstream>

#include "client/guided/path_measures.hpp"
#include "proto/evidence/machine_speed.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::guided {
namespace {

std::string describe(const PlanSettings& settings, const std::string& problem,
                     const ProblemResult& result) {
  std::ostringstream text;
  text << "step=" << settings.resolution;
  if (settings.clearance_m > 0)
    text << " clearance_m=" << settings.clearance_m;
  text << " overshoot=" << settings.overshoot << " shortcut_checks=" << settings.shortcut_checks
       << " max_checks=" << settings.max_checks << (result.gate_fired ? " gate=fired" : "");
  if (!problem.empty())  // to the end: it may have blanks
    text << " problem=" << problem;
  return cut_text(text.str(), kMaxPlannerOptionsBytes);
}

}  // namespace

Attempt make_attempt(const Reporter& reporter, const Problem& problem,
                     const PlannedProblem& planned, const PlanSettings& settings) {
  ProblemResult result = planned.result;
  if (!result.path_length)
    measure_path(reporter.robot, problem, result);
  Attempt attempt;
  attempt.report_uuid = Uuid::random();
  attempt.robot = reporter.robot.chain.digest();
  attempt.machine = reporter.machine;
  attempt.task = reporter.task;
  attempt.T_task_base = problem.T_task_base;
  PlanningRecord& record = attempt.record;
  record.outcome = planned.outcome;
  record.planner = planned.planner;
  record.planner_options = describe(settings, problem.name, result);
  record.planning_time_s = result.planning_time_s;
  record.collision_checks = result.collision_checks;
  record.projections = result.projections;
  record.time_limit_s = result.time_limit_s;
  record.sampling_mode = result.sampling_mode;
  record.share = result.share;
  record.distribution_id = result.distribution_id;
  record.distribution_revision = result.distribution_revision;
  record.processor_time_s = result.processor_time_s;
  record.machine_speed = evidence::machine_speed();
  record.hand_length_m = result.hand_length_m.value_or(0);
  record.least_clearance_m = result.least_clearance_m.value_or(0);
  if (result.waypoints)
    attempt.path = Path(*result.waypoints);
  attempt.search = planned.search;
  if (attempt.search && !batch_bytes(attempt).fits())
    attempt.search->trees.clear();
  if (attempt.search && !batch_bytes(attempt).fits())
    attempt.search.reset();
  return attempt;
}

}  // namespace kinship::guided
