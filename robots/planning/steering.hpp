#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>

#include "robots/planning/bidirectional_search.hpp"
#include "robots/planning/region_constraint.hpp"

/// The two steerings of BidirectionalSearch; for this library's sources only.
namespace kinship::planning {

/// Steers straight to the target, as far as the line is free.
class StraightSteering {
 public:
  StraightSteering(Eigen::Index dof, double step)
      : step_(step), origin_(dof), direction_(dof), target_(dof), way_(dof, kTogether) {}

  Extension extend(Tree& tree, Eigen::Index from, const Eigen::Ref<const Eigen::VectorXd>& target,
                   Aim, PlanningBudget& budget) {
    return set_out(tree.node(from), target) ? go(tree, from, 1, budget) : Extension{from, true};
  }

  /// Completes beginnings of extensions, whose node and target are known, before any check.
  void begin(const Tree& tree, std::span<SamplesAhead::Beginning* const> beginnings) {
    for (SamplesAhead::Beginning* const beginning : beginnings) {
      beginning->is_any = set_out(tree.node(beginning->near), beginning->target);
      if (beginning->is_any)
        write(1, beginning->first);
    }
  }

  /// An extension towards a sample whose first configuration is known and free.
  Extension extend_beyond(Tree& tree, Eigen::Index from,
                          const Eigen::Ref<const Eigen::VectorXd>& first,
                          const Eigen::Ref<const Eigen::VectorXd>& target, PlanningBudget& budget) {
    set_out(tree.node(from), target);
    from = tree.add(first, from);
    return is_last(1) ? Extension{from, true} : go(tree, from, 2, budget);
  }

  /// Cost besides checks, and its restoration.
  std::uint64_t spent() const { return 0; }
  void set_spent(std::uint64_t) {}

 private:
  static constexpr double kShortest = 1e-9;  // joint units: no last step as short as rounding

  /// \return whether the target differs from the origin.
  bool set_out(const Eigen::Ref<const Eigen::VectorXd>& origin,
               const Eigen::Ref<const Eigen::VectorXd>& target) {
    origin_ = origin;
    target_ = target;
    distance_ = (target_ - origin_).norm();
    if (distance_ == 0)
      return false;
    direction_ = (target_ - origin_) / distance_;
    return true;
  }

  bool is_last(int i) const { return i * step_ >= distance_ - kShortest; }

  /// The i-th configuration of the way.
  void write(int i, Eigen::Ref<Eigen::VectorXd> q) const {
    if (is_last(i))
      q = target_;
    else
      q.noalias() = origin_ + i * step_ * direction_;
  }

  /// Checks few at first: most ways are short.
  Extension go(Tree& tree, Eigen::Index from, int first, PlanningBudget& budget) {
    for (Eigen::Index together = kFewTogether;; together = kTogether) {
      Eigen::Index count = 0;
      bool arrives = false;
      for (; count < together && !arrives; ++count, ++first) {
        write(first, way_.col(count));
        arrives = is_last(first);
      }
      const Eigen::Index free = budget.free_ahead(way_.leftCols(count));
      for (Eigen::Index i = 0; i < free; ++i)
        from = tree.add(way_.col(i), from);
      if (free < count)
        return {from, false};
      if (arrives)
        return {from, true};
    }
  }

  double step_, distance_ = 0;
  Eigen::VectorXd origin_, direction_, target_;  // kept, so that a step allocates nothing
  Eigen::MatrixXd way_;
};

/// Steers along the constraint towards the target, as far as it is free and comes nearer.
class ConstrainedSteering {
 public:
  ConstrainedSteering(Eigen::Index dof, double step, RegionConstraint& constraint)
      : stepper_(step, constraint),
        constraint_(constraint),
        q_(dof),
        next_(dof),
        target_(dof),
        way_(dof, kTogether),
        origins_(dof, kSideBySide),
        targets_(dof, kSideBySide) {}

  Extension extend(Tree& tree, Eigen::Index from, const Eigen::Ref<const Eigen::VectorXd>& target,
                   Aim aim, PlanningBudget& budget) {
    q_ = tree.node(from);
    target_ = target;
    return go(tree, from, aim, budget);
  }

  /// Completes beginnings of extensions, whose node and target are known, before any check: the
  /// first steps of all are projected side by side.
  void begin(const Tree& tree, std::span<SamplesAhead::Beginning* const> beginnings) {
    const auto count = static_cast<Eigen::Index>(beginnings.size());
    for (Eigen::Index i = 0; i < count; ++i) {
      origins_.col(i) = tree.node(beginnings[static_cast<std::size_t>(i)]->near);
      targets_.col(i) = beginnings[static_cast<std::size_t>(i)]->target;
    }
    const unsigned made = stepper_.advance_together(origins_.leftCols(count),
                                                    targets_.leftCols(count), way_.leftCols(count));
    for (Eigen::Index i = 0; i < count; ++i) {
      SamplesAhead::Beginning& beginning = *beginnings[static_cast<std::size_t>(i)];
      beginning.first = way_.col(i);
      beginning.is_any = (made >> i & 1U) != 0;
      beginning.spent = 1;
      if (beginning.is_any || origins_.col(i) == targets_.col(i))
        continue;
      const std::uint64_t before = spent();
      q_ = origins_.col(i);
      beginning.is_any = stepper_.advance(q_, beginning.target, beginning.first);
      beginning.spent += spent() - before;
    }
  }

  /// An extension towards a sample whose first configuration is known and free.
  Extension extend_beyond(Tree& tree, Eigen::Index from,
                          const Eigen::Ref<const Eigen::VectorXd>& first,
                          const Eigen::Ref<const Eigen::VectorXd>& target, PlanningBudget& budget) {
    q_ = first;
    target_ = target;
    return go(tree, tree.add(first, from), Aim::Sample, budget);
  }

  /// Projections that the extensions needed, whenever they were made.
  std::uint64_t spent() const { return constraint_.projections(); }
  void set_spent(std::uint64_t spent) { constraint_.set_projections(spent); }

 private:
  enum class Next { Further, Arrived, Stuck };

  /// From q_ on. The steps are known before any check, so some are projected and checked together:
  /// those behind one that is not free were projected in vain.
  Extension go(Tree& tree, Eigen::Index from, Aim aim, PlanningBudget& budget) {
    for (;;) {
      const std::uint64_t before = spent();
      const Steps steps = ahead(aim);
      const Eigen::Index free =
          steps.count == 0 ? 0 : budget.free_ahead(way_.leftCols(steps.count));
      for (Eigen::Index i = 0; i < free; ++i)
        from = tree.add(way_.col(i), from);
      if (free < steps.count) {
        set_spent(std::min(spent(), before + static_cast<std::uint64_t>(free) + 1));
        return {from, false};
      }
      if (steps.next != Next::Further)
        return {from, steps.next == Next::Arrived};
    }
  }

  /// What the next steps lead to.
  struct Steps {
    Eigen::Index count;  ///< configurations in way_
    Next next;
  };

  /// Moves q_ on by some steps, or by a shorter one.
  Steps ahead(Aim aim) {
    if (q_ == target_)
      return {0, Next::Arrived};
    Eigen::Index count = 0;
    if (aim == Aim::Sample || !stepper_.joins(q_, target_)) {
      count = stepper_.advance_ahead(q_, target_, way_.leftCols(kSideBySide));
      if (count == 0) {
        if (!stepper_.advance(q_, target_, next_))
          return {0, Next::Stuck};
        way_.col(count++) = next_;
      }
      q_ = way_.col(count - 1);
    }
    if (aim == Aim::Node && stepper_.joins(q_, target_)) {
      way_.col(count++) = target_;
      return {count, Next::Arrived};
    }
    return {count, Next::Further};
  }

  ConstrainedStepper stepper_;
  RegionConstraint& constraint_;
  Eigen::VectorXd q_, next_, target_;  // kept, so that a step allocates nothing
  Eigen::MatrixXd way_, origins_, targets_;
};

}  // namespace kinship::planning
