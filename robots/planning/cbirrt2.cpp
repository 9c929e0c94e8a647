#include "robots/planning/cbirrt2.hpp"

#include "robots/planning/bidirectional_search.hpp"
#include "robots/planning/steering.hpp"

namespace kinship::planning {
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

}  // namespace kinship::planning
