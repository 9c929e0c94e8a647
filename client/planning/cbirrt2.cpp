#include "client/planning/cbirrt2.hpp"

#include "client/planning/bidirectional_search.hpp"
#include "client/planning/constrained_stepper.hpp"

namespace kinship::planning {
namespace {

/// Slides along the constraint towards the target, as far as it is free and comes nearer.
class ConstrainedSteering {
 public:
  ConstrainedSteering(Eigen::Index dof, double step, RegionConstraint& constraint)
      : stepper_(step, constraint), q_(dof), next_(dof) {}

  Extension extend(Tree& tree, Eigen::Index from, const Eigen::VectorXd& target, Aim aim,
                   PlanningBudget& budget) {
    q_ = tree.node(from);
    while (q_ != target) {
      const bool arrives = aim == Aim::Node && stepper_.joins(q_, target);
      if (arrives)
        next_ = target;
      else if (!stepper_.advance(q_, target, next_))
        return {from, false};
      if (!budget.is_free(next_))
        return {from, false};
      from = tree.add(next_, from);
      q_.swap(next_);
    }
    return {from, true};
  }

 private:
  ConstrainedStepper stepper_;
  Eigen::VectorXd q_, next_;  // kept, so that a step allocates nothing
};

Eigen::MatrixXd holding(const Eigen::MatrixXd& configurations, const RegionConstraint& constraint) {
  Eigen::MatrixXd kept(configurations.rows(), configurations.cols());
  Eigen::Index count = 0;
  for (const auto& q : configurations.colwise())
    if (constraint.holds(q))
      kept.col(count++) = q;
  return kept.leftCols(count);
}

}  // namespace

PlanSummary plan_cbirrt2(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const ConstrainedFreedom& freedom, const ConfigurationSampler& sampler,
                         const BirrtOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_cbirrt2", start, goals, sampler, options);
  RegionConstraint& constraint = freedom.constraint;
  PlanSummary nothing;
  if (!constraint.holds(start)) {
    nothing.reason = "start violates the constraint";
    return nothing;
  }
  const Eigen::MatrixXd reachable = holding(goals, constraint);
  if (reachable.cols() == 0 && goals.cols() > 0) {
    nothing.reason = "every goal violates the constraint";
    return nothing;
  }
  const std::uint64_t before = constraint.projections();
  PlanningBudget budget(freedom.is_free, options.max_checks, options.time_limit);
  ConstrainedSteering steering(start.size(), options.step, constraint);
  PlanSummary summary =
      BidirectionalSearch(sampler, options, steering, budget, generator).run(start, reachable);
  summary.projections = constraint.projections() - before;
  return summary;
}

}  // namespace kinship::planning
