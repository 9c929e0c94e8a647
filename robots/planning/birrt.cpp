#include "robots/planning/birrt.hpp"

#include <stdexcept>

#include "robots/planning/bidirectional_search.hpp"
#include "robots/planning/steering.hpp"

namespace kinship::planning {

void check_arguments(const char* planner, const Eigen::VectorXd& start,
                     const Eigen::MatrixXd& goals, const ConfigurationSampler& sampler,
                     const BirrtOptions& options) {
  const auto refuse = [&](const char* what) {
    throw std::invalid_argument(std::string(planner) + ": " + what);
  };
  const Eigen::Index dof = sampler.bounds().cols();
  if (dof < 1 || start.size() != dof || (goals.cols() > 0 && goals.rows() != dof))
    refuse("start, goals and bounds differ in size");
  if (!start.allFinite() || !goals.allFinite())
    refuse("start or goals are not finite");
  if (!(options.step > 0) || !(options.overshoot >= 1))
    refuse("step must be positive, overshoot at least 1");
}

PlanSummary summary_of(const PlanningBudget& budget, std::optional<Eigen::MatrixXd> path,
                       NoPath reason, FoundBy found_by) {
  PlanSummary summary;
  summary.found_by = path ? found_by : FoundBy::Nothing;
  summary.waypoints = std::move(path);
  summary.reason = reason;
  summary.collision_checks = budget.checks();
  summary.planning_time_s = budget.thread_time_s();
  return summary;
}

PlanSummary plan_birrt(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const IsFree& is_free, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_birrt", start, goals, sampler, options);
  PlanningBudget budget(is_free, options.max_checks, options.time_limit);
  StraightSteering steering(start.size(), options.step);
  return BidirectionalSearch(sampler, options, steering, budget, generator).run(start, goals);
}

std::optional<Eigen::MatrixXd> holding(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                                       const RegionConstraint& constraint, NoPath& reason) {
  if (!constraint.holds(start)) {
    reason = NoPath::StartOffConstraint;
    return std::nullopt;
  }
  Eigen::MatrixXd kept(goals.rows(), goals.cols());
  Eigen::Index count = 0;
  for (const auto& goal : goals.colwise())
    if (constraint.holds(goal))
      kept.col(count++) = goal;
  if (count == 0 && goals.cols() > 0) {
    reason = NoPath::GoalsOffConstraint;
    return std::nullopt;
  }
  return kept.leftCols(count);
}

PlanSummary plan_cbirrt2(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const ConstrainedFreedom& freedom, const ConfigurationSampler& sampler,
                         const BirrtOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_cbirrt2", start, goals, sampler, options);
  return plan_along(start, goals, freedom.constraint, [&](const Eigen::MatrixXd& reachable) {
    PlanningBudget budget(freedom.is_free, options.max_checks, options.time_limit);
    ConstrainedSteering steering(start.size(), options.step, freedom.constraint);
    return BidirectionalSearch(sampler, options, steering, budget, generator).run(start, reachable);
  });
}

PlanSummary plan_trees(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const Freedom& freedom, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator) {
  return freedom.constraint != nullptr
             ? plan_cbirrt2(start, goals, {freedom.is_free, *freedom.constraint}, sampler, options,
                            generator)
             : plan_birrt(start, goals, freedom.is_free, sampler, options, generator);
}

}  // namespace kinship::planning
