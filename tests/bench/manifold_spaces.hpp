#pragma once

#include <ompl/base/ConstrainedSpaceInformation.h>
#include <ompl/base/Constraint.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/constraint/AtlasStateSpace.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>
#include <ompl/base/spaces/constraint/TangentBundleStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "client/ompl/ompl_planners.hpp"
#include "client/ompl/state_space.hpp"
#include "robots/planning/region_constraint.hpp"

/// RRTConnect in the constrained spaces that OMPL has, as a user of OMPL sets them up.
namespace kinship::bench {

namespace ob = ompl::base;

enum class SpaceKind {
  Projected,
  OurProjection,  ///< the projected space, with the projection of RegionConstraint for OMPL's
  Atlas,
  TangentBundle
};

struct SpaceOptions {
  SpaceKind kind = SpaceKind::Projected;
  double range = 0;     ///< of RRTConnect, joint units; 0: a fifth of the space's extent
  double delta = 0.05;  ///< of the space: of a step
};

/// The bounded coordinates of a region as equations: what is beyond the bounds is 0. Of a manifold
/// if the bounds of each are one value.
class RegionEquations : public ob::Constraint {
 public:
  /// \param region  must outlive this.
  RegionEquations(Eigen::Index dof, const TaskSpaceRegion& bounds,
                  planning::RegionConstraint& region, bool projects_itself)
      : ob::Constraint(static_cast<unsigned>(dof), static_cast<unsigned>(bounded(bounds).size()),
                       planning::RegionConstraint::kWaypointTolerance),
        region_(region),
        rows_(bounded(bounds)),
        is_manifold_(std::ranges::all_of(
            rows_,
            [&](Eigen::Index row) { return bounds.bounds(0, row) == bounds.bounds(1, row); })),
        projects_itself_(projects_itself) {}

  void function(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::VectorXd> out) const override {
    const planning::RegionConstraint::Vector6 excess = region_.excess(q);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      out[static_cast<Eigen::Index>(i)] = excess[rows_[i]];
  }

  void jacobian(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::MatrixXd> out) const override {
    const planning::RegionConstraint::Matrix6 derivative = region_.derivative(q);
    const planning::RegionConstraint::Vector6 excess =
        is_manifold_ ? planning::RegionConstraint::Vector6::Ones() : region_.excess(q);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      out.row(static_cast<Eigen::Index>(i)) =
          (excess[rows_[i]] != 0 ? 1.0 : 0.0) * derivative.row(rows_[i]);
  }

  bool project(Eigen::Ref<Eigen::VectorXd> q) const override {
    if (projects_itself_) {
      region_.set_projections(region_.projections() + 1);
      return ob::Constraint::project(q);
    }
    Eigen::VectorXd projected = q;
    const bool arrived = region_.project(projected);
    q = projected;
    return arrived;
  }

 private:
  static std::vector<Eigen::Index> bounded(const TaskSpaceRegion& region) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < 6; ++i)
      if (std::isfinite(region.bounds(0, i)))
        rows.push_back(i);
    return rows;
  }

  planning::RegionConstraint& region_;
  std::vector<Eigen::Index> rows_;
  bool is_manifold_, projects_itself_;
};

/// OMPL's own never asks whether a motion's second state is free.
class WholeMotionValidator : public ob::ConstrainedMotionValidator {
 public:
  explicit WholeMotionValidator(const ob::SpaceInformationPtr& information)
      : ob::ConstrainedMotionValidator(information) {}
  using ob::ConstrainedMotionValidator::checkMotion;
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return si_->isValid(to) && ob::ConstrainedMotionValidator::checkMotion(from, to);
  }
};

/// One query in one of the spaces.
class ManifoldQuery {
 public:
  using IsFree = std::function<bool(const Eigen::VectorXd&)>;

  /// \param region, is_free  must outlive this.
  ManifoldQuery(const Eigen::Matrix2Xd& bounds, std::shared_ptr<RegionEquations> equations,
                const SpaceOptions& options, const IsFree& is_free)
      : kind_(options.kind), equations_(std::move(equations)) {
    ompl::msg::noOutputHandler();
    const auto ambient = ompl_planners::make_state_space(bounds);
    if (options.kind == SpaceKind::Atlas)
      space_ = std::make_shared<ob::AtlasStateSpace>(ambient, equations_);
    else if (options.kind == SpaceKind::TangentBundle)
      space_ = std::make_shared<ob::TangentBundleStateSpace>(ambient, equations_);
    else
      space_ = std::make_shared<ob::ProjectedStateSpace>(ambient, equations_);
    space_->setDelta(options.delta);
    if (options.kind == SpaceKind::TangentBundle)
      information_ = std::make_shared<ob::TangentBundleSpaceInformation>(space_);
    else
      information_ = std::make_shared<ob::ConstrainedSpaceInformation>(space_);
    information_->setMotionValidator(std::make_shared<WholeMotionValidator>(information_));
    information_->setStateValidityChecker([this, &is_free, bounds](const ob::State* state) {
      q_ = *state->as<ob::ConstrainedStateSpace::StateType>();
      return (q_.array() >= bounds.row(0).transpose().array()).all() &&
             (q_.array() <= bounds.row(1).transpose().array()).all() && is_free(q_);
    });
    information_->setup();
    planner_ = ompl_planners::make_ompl_planner("RRTConnect", options.range, information_);
  }

  /// Gives start and goals, all of which hold the constraint.
  void pose(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    problem_ = std::make_shared<ob::ProblemDefinition>(information_);
    problem_->addStartState(state_at(start));
    const auto targets = std::make_shared<ob::GoalStates>(information_);
    for (const auto& goal : goals.colwise())
      targets->addState(state_at(goal));
    problem_->setGoal(targets);
    planner_->setProblemDefinition(problem_);
    planner_->setup();
  }

  /// \return whether there is a path.
  template <typename Ended>
  bool solve(Ended ended) {
    return planner_->solve(ob::PlannerTerminationCondition(ended)) ==
           ob::PlannerStatus::EXACT_SOLUTION;
  }

  /// Every configuration along the path that was found: dof x n.
  Eigen::MatrixXd way() const {
    auto& path = *problem_->getSolutionPath()->as<ompl::geometric::PathGeometric>();
    std::vector<Eigen::VectorXd> passed = {configuration(*path.getState(0))};
    for (unsigned i = 1; i < path.getStateCount(); ++i) {
      std::vector<ob::State*> geodesic;
      space_->discreteGeodesic(path.getState(i - 1), path.getState(i), true, &geodesic);
      for (ob::State* state : geodesic) {
        passed.push_back(configuration(*state));
        space_->freeState(state);
      }
      passed.push_back(configuration(*path.getState(i)));
    }
    Eigen::MatrixXd way(passed.front().size(), static_cast<Eigen::Index>(passed.size()));
    for (std::size_t i = 0; i < passed.size(); ++i)
      way.col(static_cast<Eigen::Index>(i)) = passed[i];
    return way;
  }

 private:
  ob::ScopedState<> state_at(const Eigen::VectorXd& q) const {
    ob::ScopedState<> state(space_);
    state->as<ob::ConstrainedStateSpace::StateType>()->copy(q);
    if (kind_ == SpaceKind::Atlas || kind_ == SpaceKind::TangentBundle)
      space_->as<ob::AtlasStateSpace>()->anchorChart(state.get());
    return state;
  }

  /// A tangent bundle's states lie beside the manifold; a user of it projects the path.
  Eigen::VectorXd configuration(const ob::State& state) const {
    Eigen::VectorXd q = *state.as<ob::ConstrainedStateSpace::StateType>();
    if (kind_ == SpaceKind::TangentBundle)
      equations_->project(q);
    return q;
  }

  SpaceKind kind_;
  std::shared_ptr<RegionEquations> equations_;
  std::shared_ptr<ob::ConstrainedStateSpace> space_;
  ob::SpaceInformationPtr information_;
  ob::PlannerPtr planner_;
  ob::ProblemDefinitionPtr problem_;
  Eigen::VectorXd q_;  // kept, so that a question allocates nothing
};

}  // namespace kinship::bench
