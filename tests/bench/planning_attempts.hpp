#pragma once

#include <ompl/base/goals/GoalStates.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "client/planning/birrt.hpp"
#include "client/planning/planning_budget.hpp"
#include "robots/collision/collision_world.hpp"

/// What the planning benchmarks share: instances, attempts, RRTConnect of OMPL with our limits.
namespace kinship::bench {

inline constexpr std::uint64_t kMaxPlanChecks = 200'000;
/// Of OMPL's: it can project for minutes without one check. A plan that it ends counts all checks.
inline constexpr double kMaxOmplTime_s = 10;

struct Instance {
  Eigen::VectorXd start;
  Eigen::MatrixXd goals;
};

struct Attempt {
  bool solved = false;
  double checks = 0;
  double time_s = 0;  ///< CPU time of the thread
  double projections = 0;
};

inline Attempt attempt_of(const planning::PlanSummary& summary) {
  return {summary.waypoints.has_value(), static_cast<double>(summary.collision_checks),
          summary.planning_time_s, static_cast<double>(summary.projections)};
}

/// RRTConnect in a prepared space: states, validity and resolution are the caller's.
/// \param range     of one extension, joint units; 0: OMPL's choice.
/// \param to_state  copies a configuration into a state of the space.
inline Attempt run_rrt_connect(
    ompl::geometric::SimpleSetup& setup, const Instance& instance, double range,
    collision::CollisionWorld& world,
    const std::function<void(const Eigen::VectorXd&, ompl::base::State&)>& to_state) {
  namespace ob = ompl::base;
  const std::uint64_t before = world.checks();
  const double begin_s = planning::thread_time_s();
  const auto& information = setup.getSpaceInformation();
  ob::ScopedState<> state(setup.getStateSpace());
  to_state(instance.start, *state.get());
  setup.setStartState(state);
  const auto goals = std::make_shared<ob::GoalStates>(information);
  for (Eigen::Index i = 0; i < instance.goals.cols(); ++i) {
    to_state(instance.goals.col(i), *state.get());
    goals->addState(state);
  }
  setup.setGoal(goals);
  const auto planner = std::make_shared<ompl::geometric::RRTConnect>(information);
  if (range > 0)
    planner->setRange(range);
  setup.setPlanner(planner);
  const auto status = setup.solve(ob::PlannerTerminationCondition([&world, before, begin_s] {
    return world.checks() - before >= kMaxPlanChecks ||
           planning::thread_time_s() - begin_s >= kMaxOmplTime_s;
  }));
  const bool solved = status == ob::PlannerStatus::EXACT_SOLUTION;
  return {solved, static_cast<double>(solved ? world.checks() - before : kMaxPlanChecks),
          planning::thread_time_s() - begin_s};
}

inline void print_header() {
  std::cout << std::fixed << std::setprecision(1)
            << "planner                       solved        mean      median   geometric"
               "     ms/plan    us/check projections\n";
}

inline void print(const std::string& name, const std::vector<Attempt>& attempts) {
  double checks = 0, logs = 0, time_s = 0, projections = 0;
  int solved = 0;
  std::vector<double> all;
  for (const Attempt& attempt : attempts) {
    checks += attempt.checks;
    logs += std::log(attempt.checks);
    time_s += attempt.time_s;
    projections += attempt.projections;
    solved += attempt.solved;
    all.push_back(attempt.checks);
  }
  std::sort(all.begin(), all.end());
  const auto count = static_cast<double>(attempts.size());
  std::cout << std::left << std::setw(28) << name << std::right << std::setw(8) << solved
            << std::setw(12) << checks / count << std::setw(12)
            << (all.empty() ? 0 : all[all.size() / 2]) << std::setw(12) << std::exp(logs / count)
            << std::setw(12) << 1e3 * time_s / count << std::setw(12) << 1e6 * time_s / checks
            << std::setw(12) << projections / count << '\n';
}

}  // namespace kinship::bench
