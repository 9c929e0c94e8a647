#pragma once

#include <Eigen/Core>

#include "robots/planning/bidirectional_search.hpp"
#include "robots/planning/constrained_stepper.hpp"

/// The two steerings of BidirectionalSearch; for this library's sources only.
namespace kinship::planning {

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
      const bool last = i * step_ >= distance - kShortest;
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
  static constexpr double kShortest = 1e-9;  // joint units: no last step as short as rounding

  double step_;
  Eigen::VectorXd q_;  // kept, so that a step allocates nothing
};

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

}  // namespace kinship::planning
