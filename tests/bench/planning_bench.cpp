// Collision checks and time of our uniform BiRRT against OMPL's RRTConnect, side by side: the
// same instances of the shelf cell, goals, bounds and resolution.
// Usage: planning_bench [ROBOT] [INSTANCES]

#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>

#include "client/planning/birrt.hpp"
#include "client/planning/state_space.hpp"
#include "tests/bench/shelf_cell.hpp"

namespace kinship::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kStep = 0.05;
constexpr std::uint64_t kMaxChecks = 200'000;

struct Instance {
  Eigen::VectorXd start;
  Eigen::MatrixXd goals;
};

struct Attempt {
  bool solved = false;
  double checks = 0;
  double time_s = 0;
};

Attempt run_birrt(const Instance& instance, collision::CollisionWorld& world,
                  const kinematics::Chain& chain, double overshoot, std::uint64_t seed) {
  planning::BirrtOptions options;
  options.step = kStep;
  options.overshoot = overshoot;
  options.max_checks = kMaxChecks;
  options.time_limit = std::chrono::seconds(60);
  const planning::ConfigurationSampler sampler(planning::planning_bounds(chain, instance.start));
  std::mt19937_64 generator(seed);
  const auto summary = planning::plan_birrt(
      instance.start, instance.goals, [&](const Eigen::VectorXd& q) { return !world.collides(q); },
      sampler, options, generator);
  return {summary.waypoints.has_value(), static_cast<double>(summary.collision_checks),
          summary.planning_time_s};
}

/// \param range  of one extension, joint units; 0: OMPL's choice.
Attempt run_ompl(const Instance& instance, collision::CollisionWorld& world,
                 const kinematics::Chain& chain, double range, std::uint64_t seed) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(seed + 1);
  const auto space = planning::make_state_space(planning::planning_bounds(chain, instance.start));
  og::SimpleSetup setup(space);
  const std::uint64_t before = world.checks();
  setup.setStateValidityChecker([&](const ob::State* state) {
    return !world.collides(planning::to_configuration(*state, chain.dof()));
  });
  const auto& information = setup.getSpaceInformation();
  information->setStateValidityCheckingResolution(kStep / space->getMaximumExtent());
  ob::ScopedState<> state(space);
  planning::copy_to_state(instance.start, *state.get());
  setup.setStartState(state);
  const auto goals = std::make_shared<ob::GoalStates>(information);
  for (Eigen::Index i = 0; i < instance.goals.cols(); ++i) {
    planning::copy_to_state(instance.goals.col(i), *state.get());
    goals->addState(state);
  }
  setup.setGoal(goals);
  const auto planner = std::make_shared<og::RRTConnect>(information);
  if (range > 0)
    planner->setRange(range);
  setup.setPlanner(planner);
  const auto status = setup.solve(
      ob::PlannerTerminationCondition([&] { return world.checks() - before >= kMaxChecks; }));
  return {status == ob::PlannerStatus::EXACT_SOLUTION, static_cast<double>(world.checks() - before),
          setup.getLastPlanComputationTime()};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

void print(const std::string& name, const std::vector<Attempt>& attempts) {
  double checks = 0, logs = 0, time_s = 0;
  int solved = 0;
  std::vector<double> all;
  for (const Attempt& attempt : attempts) {
    checks += attempt.checks;
    logs += std::log(attempt.checks);
    time_s += attempt.time_s;
    solved += attempt.solved;
    all.push_back(attempt.checks);
  }
  const auto count = static_cast<double>(attempts.size());
  std::cout << std::left << std::setw(28) << name << std::right << std::setw(8) << solved
            << std::setw(12) << checks / count << std::setw(12) << median(all) << std::setw(12)
            << std::exp(logs / count) << std::setw(12) << 1e3 * time_s / count << std::setw(12)
            << 1e6 * time_s / checks << '\n';
}

int run(const std::string& robot, int instances) {
  const kinematics::Chain chain = test::model_chain(robot);
  const geometry::RobotShapes shapes = model_shapes(robot);
  std::vector<std::vector<Attempt>> attempts(5);
  for (int i = 0; i < instances; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    std::mt19937_64 generator(seed);
    const ShelfCell cell = make_shelf_cell(chain, generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
    const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_start, middle);
    if (starts.cols() == 0)
      continue;
    const Instance instance = {starts.col(0),
                               free_configurations(chain, world, cell.T_base_goal, starts.col(0))};
    if (instance.goals.cols() == 0)
      continue;
    attempts[0].push_back(run_birrt(instance, world, chain, 1.0, seed));
    attempts[1].push_back(run_birrt(instance, world, chain, 1.5, seed));
    attempts[2].push_back(run_ompl(instance, world, chain, 0, seed));
    attempts[3].push_back(run_ompl(instance, world, chain, 0.5, seed));
    attempts[4].push_back(run_ompl(instance, world, chain, 100, seed));
  }
  std::cout << robot << ", " << attempts[0].size() << " of " << instances << " instances, step "
            << kStep << ", at most " << kMaxChecks << " checks\n"
            << std::fixed << std::setprecision(1)
            << "planner                       solved        mean      median    geometric"
               "     ms/plan    us/check\n";
  print("BiRRT, overshoot 1", attempts[0]);
  print("BiRRT, overshoot 1.5", attempts[1]);
  print("RRTConnect, range of OMPL", attempts[2]);
  print("RRTConnect, range 0.5", attempts[3]);
  print("RRTConnect, range unlimited", attempts[4]);
  return attempts[0].empty() ? 1 : 0;
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  return kinship::bench::run(argc > 1 ? argv[1] : "ur10e", argc > 2 ? std::atoi(argv[2]) : 50);
}
