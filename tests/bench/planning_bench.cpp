// Collision checks of our uniform planners beside OMPL's RRTConnect: the same instances, goals,
// bounds and steps. RRTConnect runs as kinship-plan runs it: it knows all goals from the beginning.
// Free: BiRRT in the shelf cell, also beside RRTConnect as OMPL alone runs it. Upright: CBiRRT2
// carrying a container over a post into a bin, tilt-limited; RRTConnect then runs on
// RegionStateSpace, because OMPL's own projected space leaves gaps of two steps. What is not solved
// counts the checks that it was allowed.
//
//   planning_bench free | upright

#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/RandomNumbers.h>

#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/ompl/ompl_planner.hpp"
#include "client/ompl/state_space.hpp"
#include "robots/planning/birrt.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/support/carrying_cell.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kMaxChecks = 200'000;
constexpr int kInstances = 30;

/// What a planner is asked: free of collision, and within a region if there is one.
struct Instance {
  const kinematics::Chain& chain;
  collision::CollisionWorld& world;
  const TaskSpaceRegion* region;  ///< null: none
  Eigen::VectorXd start;
  Eigen::MatrixXd goals;
  std::uint64_t seed;
};

planning::BirrtOptions limits(const Instance& instance) {
  planning::BirrtOptions options;
  options.step = instance.region == nullptr ? 0.05 : 0.1;
  options.overshoot = 1;
  options.max_checks = kMaxChecks;
  options.time_limit = std::chrono::seconds(30);
  return options;
}

/// With the planner of OMPL that is named, or with ours.
planning::PlanSummary plan(const Instance& instance,
                           const std::optional<ompl_planners::OmplOptions>& ompl,
                           const planning::IsFree& is_free) {
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(instance.chain, instance.start);
  const planning::ConfigurationSampler sampler(bounds);
  std::mt19937_64 generator(instance.seed);
  ompl::RNG::setSeed(instance.seed + 1);
  if (instance.region == nullptr)
    return ompl ? ompl_planners::plan_with_ompl(instance.start, instance.goals, is_free, sampler,
                                                *ompl, generator)
                : planning::plan_birrt(instance.start, instance.goals, is_free, sampler,
                                       limits(instance), generator);
  planning::RegionConstraint constraint(instance.chain, *instance.region,
                                        Eigen::Isometry3d::Identity(), bounds);
  const planning::ConstrainedFreedom freedom{is_free, constraint};
  return ompl ? ompl_planners::plan_with_ompl(instance.start, instance.goals, freedom, sampler,
                                              *ompl, generator)
              : planning::plan_cbirrt2(instance.start, instance.goals, freedom, sampler,
                                       limits(instance), generator);
}

planning::PlanSummary plan(const Instance& instance,
                           const std::optional<ompl_planners::OmplOptions>& ompl) {
  return plan(instance, ompl, planning::free_in(instance.world));
}

/// With ours, but FCL is asked for one configuration after the other.
planning::PlanSummary plan_by_fcl(const Instance& instance) {
  return plan(instance, std::nullopt, [&](const Eigen::VectorXd& q) {
    return !instance.world.find_contact(q).has_value();
  });
}

/// RRTConnect in a space of OMPL's, as a user of OMPL sets it up.
planning::PlanSummary plan_with_ompl_alone(const Instance& instance) {
  namespace ob = ompl::base;
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(instance.chain, instance.start);
  const auto space = ompl_planners::make_state_space(bounds);
  ompl::RNG::setSeed(instance.seed + 1);
  ompl::geometric::SimpleSetup setup(space);
  setup.setStateValidityChecker([&](const ob::State* state) {
    return !instance.world.collides(ompl_planners::to_configuration(*state, instance.chain.dof()));
  });
  const auto& information = setup.getSpaceInformation();
  information->setStateValidityCheckingResolution(limits(instance).step /
                                                  space->getMaximumExtent());
  ob::ScopedState<> state(space);
  ompl_planners::copy_to_state(instance.start, *state.get());
  setup.setStartState(state);
  const auto goals = std::make_shared<ob::GoalStates>(information);
  for (Eigen::Index i = 0; i < instance.goals.cols(); ++i) {
    ompl_planners::copy_to_state(instance.goals.col(i), *state.get());
    goals->addState(state);
  }
  setup.setGoal(goals);
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(information));
  const std::uint64_t before = instance.world.checks();
  const double start_s = thread_cpu_s();
  const ob::PlannerStatus status = setup.solve(ob::PlannerTerminationCondition(
      [&] { return instance.world.checks() - before >= kMaxChecks; }));
  planning::PlanSummary summary;
  summary.collision_checks = instance.world.checks() - before;
  summary.planning_time_s = thread_cpu_s() - start_s;
  if (status == ob::PlannerStatus::EXACT_SOLUTION)
    summary.waypoints = instance.start;
  return summary;
}

/// Sums over the instances of one planner.
struct Score {
  double checks = 0, time_s = 0;
  int plans = 0, solved = 0;

  void add(const planning::PlanSummary& summary) {
    checks += static_cast<double>(summary.waypoints ? summary.collision_checks : kMaxChecks);
    time_s += summary.planning_time_s;
    solved += summary.waypoints ? 1 : 0;
    ++plans;
  }
};

/// Ours, also by FCL alone, RRTConnect as OMPL sets it up, and with a range tuned by hand.
class Comparison {
 public:
  void add(const Instance& instance) {
    ours_.add(plan(instance, std::nullopt));
    by_fcl_.add(plan_by_fcl(instance));
    const ompl_planners::OmplOptions as_it_comes{.range = 0, .limits = limits(instance)};
    theirs_.add(plan(instance, as_it_comes));
    const ompl_planners::OmplOptions tuned{.range = 0.5, .limits = limits(instance)};
    tuned_.add(plan(instance, tuned));
    if (instance.region == nullptr)
      ompl_alone_.add(plan_with_ompl_alone(instance));
  }

  void print_as(const std::string& robot) const {
    if (ours_.plans == 0)
      throw std::runtime_error(robot + ": no instance has a start and a goal");
    const double plans = ours_.plans;
    const auto checks = [&](const std::string& name, const Score& reference) {
      print({.name = robot + ", mean checks, to " + name,
             .value = ours_.checks / plans,
             .unit = "checks",
             .reference = Reference{name, reference.checks / plans},
             .note = "solved " + std::to_string(ours_.solved) + " and " +
                     std::to_string(reference.solved) + " of " + std::to_string(ours_.plans)});
    };
    checks("RRTConnect", theirs_);
    checks("RRTConnect, range 0.5", tuned_);
    if (ompl_alone_.plans > 0)
      checks("RRTConnect of OMPL alone", ompl_alone_);
    print({.name = robot + ", CPU time of a plan",
           .value = 1e3 * ours_.time_s / plans,
           .unit = "ms",
           .reference = Reference{"RRTConnect", 1e3 * theirs_.time_s / plans}});
    print({.name = robot + ", CPU time of a plan, to FCL",
           .value = 1e3 * ours_.time_s / plans,
           .unit = "ms",
           .reference =
               Reference{"the same plan, FCL asked one by one", 1e3 * by_fcl_.time_s / plans},
           .ratio_budget = 1.0 / 8,
           .note = "checks " + std::to_string(static_cast<std::uint64_t>(ours_.checks)) + " and " +
                   std::to_string(static_cast<std::uint64_t>(by_fcl_.checks))});
  }

 private:
  Score ours_, by_fcl_, theirs_, tuned_, ompl_alone_;
};

void plan_in_shelf(const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  const geometry::RobotShapes shapes = model_shapes(robot);
  Comparison comparison;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    std::mt19937_64 generator(seed);
    const ShelfCell cell = make_shelf_cell(chain, generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
    const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_start, middle);
    if (starts.cols() == 0)
      continue;
    const Eigen::MatrixXd goals =
        free_configurations(chain, world, cell.T_base_goal, starts.col(0));
    if (goals.cols() > 0)
      comparison.add({chain, world, nullptr, starts.col(0), goals, seed});
  }
  comparison.print_as(robot);
}

/// Free configurations at the place, the hand turned by nothing or by half a turn.
Eigen::MatrixXd place_configurations(const kinematics::Chain& chain,
                                     collision::CollisionWorld& world,
                                     const Eigen::Isometry3d& T_base_place,
                                     const Eigen::VectorXd& start) {
  const Eigen::Isometry3d turned = T_base_place * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  const Eigen::MatrixXd one = free_configurations(chain, world, T_base_place, start);
  const Eigen::MatrixXd other = free_configurations(chain, world, turned, start);
  Eigen::MatrixXd goals(chain.dof(), one.cols() + other.cols());
  goals << one, other;
  return goals;
}

void carry_upright(const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  const geometry::RobotShapes shapes = model_shapes(robot);
  Comparison comparison;
  for (std::uint64_t seed = 0; seed < kInstances; ++seed) {
    std::mt19937_64 generator(seed);
    const test::CarryingCell cell = test::make_carrying_cell(chain, generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
    const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_pick, middle);
    if (starts.cols() == 0)
      continue;
    const Eigen::MatrixXd goals =
        place_configurations(chain, world, cell.T_base_place, starts.col(0));
    if (goals.cols() > 0)
      comparison.add({chain, world, &cell.upright, starts.col(0), goals, seed});
  }
  comparison.print_as(robot);
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  const std::string cell = argc > 1 ? argv[1] : "";
  if (cell == "free")
    for (const char* robot : {"panda", "iiwa14", "ur10e"})
      kinship::bench::plan_in_shelf(robot);
  else if (cell == "upright")
    for (const char* robot : {"panda", "iiwa14", "sawyer", "sara_like"})
      kinship::bench::carry_upright(robot);
  else
    std::cerr << "usage: planning_bench free | upright\n";
  return cell == "free" || cell == "upright" ? 0 : 2;
}
