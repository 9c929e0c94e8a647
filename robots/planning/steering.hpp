#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>

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

  /// The first configuration of an extension, before any check. \return false: none, the target is
  /// the origin.
  bool first_of(const Eigen::Ref<const Eigen::VectorXd>& origin,
                const Eigen::Ref<const Eigen::VectorXd>& target, Eigen::VectorXd& first) {
    if (!set_out(origin, target))
      return false;
    write(1, first);
    return true;
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
        way_(dof, kTogether) {}

  Extension extend(Tree& tree, Eigen::Index from, const Eigen::Ref<const Eigen::VectorXd>& target,
                   Aim aim, PlanningBudget& budget) {
    q_ = tree.node(from);
    target_ = target;
    return go(tree, from, aim, budget);
  }

  /// The first configuration of an extension towards a sample, before any check.
  /// \return false: there is none.
  bool first_of(const Eigen::Ref<const Eigen::VectorXd>& origin,
                const Eigen::Ref<const Eigen::VectorXd>& target, Eigen::VectorXd& first) {
    q_ = origin;
    target_ = target;
    if (q_ == target_ || !stepper_.advance(q_, target_, next_))
      return false;
    first = next_;
    return true;
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

  /// From q_ on. The steps are known before any check, so a few are checked together, more and
  /// more: those behind one that is not free were projected in vain.
  Extension go(Tree& tree, Eigen::Index from, Aim aim, PlanningBudget& budget) {
    constexpr Eigen::Index kFirst = 2;
    for (Eigen::Index together = kFirst;; together = std::min(2 * together, kTogether)) {
      Eigen::Index count = 0;
      Next next = Next::Further;
      while (count < together && (next = step(aim)) == Next::Further) {
        way_.col(count) = q_;
        spent_[static_cast<std::size_t>(count++)] = spent();
      }
      const Eigen::Index free = count == 0 ? 0 : budget.free_ahead(way_.leftCols(count));
      for (Eigen::Index i = 0; i < free; ++i)
        from = tree.add(way_.col(i), from);
      if (free < count) {
        set_spent(spent_[static_cast<std::size_t>(free)]);
        return {from, false};
      }
      if (next != Next::Further)
        return {from, next == Next::Arrived};
    }
  }

  /// Moves q_ on.
  Next step(Aim aim) {
    if (q_ == target_)
      return Next::Arrived;
    if (aim == Aim::Node && stepper_.joins(q_, target_))
      next_ = target_;
    else if (!stepper_.advance(q_, target_, next_))
      return Next::Stuck;
    q_.swap(next_);
    return Next::Further;
  }

  ConstrainedStepper stepper_;
  RegionConstraint& constraint_;
  Eigen::VectorXd q_, next_, target_;  // kept, so that a step allocates nothing
  Eigen::MatrixXd way_;
  std::array<std::uint64_t, kTogether> spent_{};  // up to each configuration of the way
};

}  // namespace kinship::planning
