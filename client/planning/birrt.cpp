#include "client/planning/birrt.hpp"

#include <stdexcept>

#include "client/planning/bidirectional_search.hpp"

namespace kinship::planning {
namespace {

constexpr double kTolerance = 1e-9;  // joint units: no last step as short as rounding

/// Goes straight to the target, as far as it is free.
class StraightSteering {
 public:
  StraightSteering(Eigen::Index dof, double step) : step_(step), q_(dof) {}

  Extension extend(Tree& tree, Eigen::Index from, const Eigen::VectorXd& target, Aim,
                   PlanningBudget& budget) {
    const Eigen::VectorXd origin = tree.node(from);
    const double distance = (target - origin).norm();
    if (distance == 0)
      return {from, true};
    const Eigen::VectorXd direction = (target - origin) / distance;
    for (int i = 1;; ++i) {
      const bool last = i * step_ >= distance - kTolerance;
      if (last)
        q_ = target;
      else
        q_.noalias() = origin + i * step_ * direction;
      if (!budget.is_free(q_))
        return {from, false};
      from = tree.add(q_, from);
      if (last)
        return {from, true};
    }
  }

 private:
  double step_;
  Eigen::VectorXd q_;  // kept, so that a step allocates nothing
};

}  // namespace

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

PlanSummary plan_birrt(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                       const IsFree& is_free, const ConfigurationSampler& sampler,
                       const BirrtOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_birrt", start, goals, sampler, options);
  PlanningBudget budget(is_free, options.max_checks, options.time_limit);
  StraightSteering steering(start.size(), options.step);
  return BidirectionalSearch(sampler, options, steering, budget, generator).run(start, goals);
}

}  // namespace kinship::planning
