// Collision checks and time of our uniform BiRRT against OMPL's RRTConnect, side by side: the
// same instances of the shelf cell, goals, bounds and resolution.
// Usage: planning_bench [ROBOT] [INSTANCES]

#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>

#include <cstdlib>
#include <iostream>

#include "client/planning/birrt.hpp"
#include "client/planning/state_space.hpp"
#include "tests/bench/planning_attempts.hpp"
#include "tests/bench/shelf_cell.hpp"

namespace kinship::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kStep = 0.05;

Attempt run_birrt(const Instance& instance, collision::CollisionWorld& world,
                  const kinematics::Chain& chain, double overshoot, std::uint64_t seed) {
  planning::BirrtOptions options;
  options.step = kStep;
  options.overshoot = overshoot;
  options.max_checks = kMaxPlanChecks;
  options.time_limit = std::chrono::seconds(600);
  const planning::ConfigurationSampler sampler(planning::planning_bounds(chain, instance.start));
  std::mt19937_64 generator(seed);
  return attempt_of(planning::plan_birrt(
      instance.start, instance.goals, [&](const Eigen::VectorXd& q) { return !world.collides(q); },
      sampler, options, generator));
}

/// \param range  of one extension, joint units; 0: OMPL's choice.
Attempt run_ompl(const Instance& instance, collision::CollisionWorld& world,
                 const kinematics::Chain& chain, double range, std::uint64_t seed) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(seed + 1);
  const auto space = planning::make_state_space(planning::planning_bounds(chain, instance.start));
  og::SimpleSetup setup(space);
  setup.setStateValidityChecker([&](const ob::State* state) {
    return !world.collides(planning::to_configuration(*state, chain.dof()));
  });
  setup.getSpaceInformation()->setStateValidityCheckingResolution(kStep /
                                                                  space->getMaximumExtent());
  return run_rrt_connect(
      setup, instance, range, world,
      [](const Eigen::VectorXd& q, ob::State& state) { planning::copy_to_state(q, state); });
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
            << kStep << ", at most " << kMaxPlanChecks << " checks\n";
  print_header();
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
