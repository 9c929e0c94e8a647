#include "client/ompl/ompl_planner.hpp"

#include <ompl/base/ConstrainedSpaceInformation.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/util/Console.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>

#include "client/ompl/guided_state_sampler.hpp"
#include "client/ompl/motion_validity.hpp"
#include "client/ompl/ompl_planners.hpp"
#include "client/ompl/region_state_space.hpp"
#include "client/ompl/state_space.hpp"
#include "proto/types/failure.hpp"
#include "robots/planning/bidirectional_search.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_budget.hpp"

namespace kinship::ompl_planners {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

/// A space of OMPL with the functions that turn its states into configurations.
struct PlanningSpace {
  ob::SpaceInformationPtr information;
  std::function<Eigen::VectorXd(const ob::State&)> configuration;
  std::function<void(const Eigen::VectorXd&, ob::State&)> copy_to;
  /// The checked configurations between two states: dof x n.
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&, const Eigen::VectorXd&)> way;
  std::function<bool(const Eigen::VectorXd&)> holds;  ///< the constraint; empty: there is none
};

PlanningSpace straight_space(const Eigen::Matrix2Xd& bounds, double step) {
  const auto space = make_state_space(bounds);
  PlanningSpace planning;
  planning.information = std::make_shared<ob::SpaceInformation>(space);
  // A little shorter, so that a distance of whole steps is cut alike here and there.
  const double part = step * (1 - 1e-9);
  planning.information->setStateValidityCheckingResolution(part / space->getMaximumExtent());
  planning.information->setMotionValidator(
      std::make_shared<StraightMotionValidator>(planning.information));
  const Eigen::Index dof = bounds.cols();
  planning.configuration = [dof](const ob::State& state) { return to_configuration(state, dof); };
  planning.copy_to = copy_to_state;
  planning.way = [part](const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    Eigen::MatrixXd ends(from.size(), 2);
    ends << from, to;
    return planning::densified(ends, part);
  };
  return planning;
}

PlanningSpace constrained_space(const Eigen::Matrix2Xd& bounds,
                                planning::RegionConstraint& constraint, double step) {
  const auto space = std::make_shared<RegionStateSpace>(make_state_space(bounds), constraint, step);
  PlanningSpace planning;
  planning.information = std::make_shared<ob::ConstrainedSpaceInformation>(space);
  planning.information->setMotionValidator(
      std::make_shared<RegionMotionValidator>(planning.information));
  planning.configuration = to_constrained_configuration;
  planning.copy_to = [](const Eigen::VectorXd& q, ob::State& state) {
    state.as<ob::ConstrainedStateSpace::StateType>()->copy(q);
  };
  planning.way = [space](const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    auto way = space->way(from, to);
    if (!way)
      throw std::logic_error("plan_with_ompl: OMPL's path has a motion that was never checked");
    return *std::move(way);
  };
  planning.holds = [&constraint](const Eigen::VectorXd& q) { return constraint.holds(q); };
  return planning;
}

/// One query in a space.
class OmplQuery {
 public:
  OmplQuery(PlanningSpace space, const planning::IsFree& is_free, const OmplOptions& options)
      : space_(std::move(space)),
        budget_(is_free, options.limits.max_checks, options.limits.time_limit),
        end_(std::chrono::steady_clock::now() + options.limits.time_limit),
        planner_(make_ompl_planner(options.planner, options.range, space_.information)) {
    space_.information->setStateValidityChecker(std::make_shared<SeveralStatesValidity>(
        space_.information,
        [this](const ob::State& state) { return is_free_at(space_.configuration(state)); },
        [this](const Eigen::Ref<const Eigen::MatrixXd>& qs) { return free_ahead(qs); },
        [&is_free](const Eigen::Ref<const Eigen::MatrixXd>& way) {
          return is_free.way_is_free(way);
        }));
    problem_ = std::make_shared<ob::ProblemDefinition>(space_.information);
    const auto first_path =
        std::make_shared<ob::PathLengthOptimizationObjective>(space_.information);
    first_path->setCostThreshold(first_path->infiniteCost());
    problem_->setOptimizationObjective(first_path);
  }

  planning::PlanSummary run(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    planning::PlanSummary summary;
    summary.reason = pose(start, goals);
    if (summary.reason == planning::NoPath::None)
      summary.waypoints = standstill_ ? standstill_ : solve(summary);
    summary.collision_checks = budget_.checks();
    summary.planning_time_s = budget_.thread_time_s();
    return summary;
  }

 private:
  bool is_free_at(const Eigen::VectorXd& q) {
    const bool free = (!space_.holds || space_.holds(q)) && budget_.is_free(q);
    if (budget_.reason() != planning::NoPath::None)
      ended_ = true;
    return free;
  }

  Eigen::Index free_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
    Eigen::Index holding = space_.holds ? 0 : qs.cols();
    while (holding < qs.cols() && space_.holds(qs.col(holding)))
      ++holding;
    const Eigen::Index free = holding == 0 ? 0 : budget_.free_ahead(qs.leftCols(holding));
    if (budget_.reason() != planning::NoPath::None)
      ended_ = true;
    return free;
  }

  /// Gives OMPL start and free goals. \return why there is nothing to plan, if so.
  planning::NoPath pose(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
    if (goals.cols() == 0)
      return planning::NoPath::NoGoal;
    if (!budget_.is_free(start))
      return budget_.exhausted() ? budget_.reason() : planning::NoPath::StartCollides;
    const auto targets = std::make_shared<ob::GoalStates>(space_.information);
    ob::ScopedState<> state(space_.information);
    for (const auto& goal : goals.colwise()) {
      const Eigen::VectorXd q = goal;
      if (!budget_.is_free(q))
        continue;
      space_.copy_to(q, *state.get());
      targets->addState(state);
      if (q == start)
        standstill_ = goal.replicate<1, 2>();
    }
    if (budget_.exhausted())
      return budget_.reason();
    if (!targets->hasStates())
      return planning::NoPath::GoalsCollide;
    space_.copy_to(start, *state.get());
    problem_->addStartState(state);
    problem_->setGoal(targets);
    return planning::NoPath::None;
  }

  std::optional<Eigen::MatrixXd> solve(planning::PlanSummary& summary) {
    // Atomic and a constant: some planners ask from a second thread.
    const ob::PlannerTerminationCondition ended(
        [this] { return ended_ || std::chrono::steady_clock::now() >= end_; });
    planner_->setProblemDefinition(problem_);
    planner_->setup();
    const ob::PlannerStatus status = planner_->solve(ended);
    if (status == ob::PlannerStatus::EXACT_SOLUTION)
      return waypoints();
    summary.reason = budget_.exhausted() ? budget_.reason() : planning::NoPath::GaveUp;
    if (summary.reason == planning::NoPath::GaveUp)
      summary.planner_message = "OMPL: " + status.asString();
    return std::nullopt;
  }

  Eigen::MatrixXd waypoints() const {
    const auto& path = *problem_->getSolutionPath()->as<og::PathGeometric>();
    Eigen::MatrixXd waypoints = space_.configuration(*path.getState(0));
    for (std::size_t i = 1; i < path.getStateCount(); ++i) {
      const Eigen::VectorXd last = waypoints.rightCols<1>();
      const Eigen::VectorXd next =
          space_.configuration(*path.getState(static_cast<unsigned int>(i)));
      if (next == last)
        continue;
      const Eigen::MatrixXd way = space_.way(last, next);
      const Eigen::Index before = waypoints.cols();
      waypoints.conservativeResize(Eigen::NoChange, before + way.cols() - 1);
      waypoints.rightCols(way.cols() - 1) = way.rightCols(way.cols() - 1);
    }
    return waypoints;
  }

  PlanningSpace space_;
  planning::PlanningBudget budget_;
  std::chrono::time_point<std::chrono::steady_clock, std::chrono::duration<double>> end_;
  std::atomic<bool> ended_ = false;
  ob::PlannerPtr planner_;
  ob::ProblemDefinitionPtr problem_;
  std::optional<Eigen::MatrixXd> standstill_;
};

planning::PlanSummary run(PlanningSpace space, const Eigen::VectorXd& start,
                          const Eigen::MatrixXd& goals, const planning::IsFree& is_free,
                          const OmplOptions& options) {
  try {
    return OmplQuery(std::move(space), is_free, options).run(start, goals);
  } catch (const ompl::Exception& exception) {
    throw Failure(ErrorCode::Internal,
                  "OMPL planner '" + options.planner + "': " + exception.what());
  }
}

}  // namespace

planning::PlanSummary plan_with_ompl(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                                     const planning::IsFree& is_free,
                                     const planning::ConfigurationSampler& sampler,
                                     const OmplOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_with_ompl", start, goals, sampler, options.limits);
  ompl::msg::noOutputHandler();
  PlanningSpace space = straight_space(sampler.bounds(), options.limits.step);
  install_guided_sampler(*space.information->getStateSpace(),
                         std::make_shared<planning::ConfigurationSampler>(sampler), generator());
  return run(std::move(space), start, goals, is_free, options);
}

planning::PlanSummary plan_with_ompl(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                                     const planning::ConstrainedFreedom& freedom,
                                     const planning::ConfigurationSampler& sampler,
                                     const OmplOptions& options, std::mt19937_64& generator) {
  check_arguments("plan_with_ompl", start, goals, sampler, options.limits);
  ompl::msg::noOutputHandler();
  return plan_along(start, goals, freedom.constraint, [&](const Eigen::MatrixXd& reachable) {
    PlanningSpace space =
        constrained_space(sampler.bounds(), freedom.constraint, options.limits.step);
    install_guided_sampler(*space.information->getStateSpace(),
                           std::make_shared<planning::ConfigurationSampler>(sampler), generator());
    return run(std::move(space), start, reachable, freedom.is_free, options);
  });
}

}  // namespace kinship::ompl_planners
