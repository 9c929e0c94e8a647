// Collision checks and time of our uniform CBiRRT2 against OMPL's RRTConnect on a projected space,
// side by side: tilt-limited carrying over a post into a bin, the same instances, goals, bounds,
// constraint and steps. The space is RegionStateSpace: OMPL's own leaves gaps of two steps and
// never asks about the end of a motion, so its counts are of paths that nobody checked.
// Usage: constrained_planning_bench [ROBOT] [INSTANCES]

#include <ompl/util/RandomNumbers.h>

#include <cstdlib>
#include <iostream>

#include "client/planning/cbirrt2.hpp"
#include "client/planning/ompl_planner.hpp"
#include "tests/bench/planning_attempts.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/support/carrying_cell.hpp"

namespace kinship::bench {
namespace {

constexpr double kStep = 0.1;

struct Carrying {
  const kinematics::Chain& chain;
  collision::CollisionWorld& world;
  const TaskSpaceRegion& upright;
  Instance instance;
  Eigen::Matrix2Xd bounds;

  planning::RegionConstraint constraint() const {
    return {chain, upright, Eigen::Isometry3d::Identity(), bounds};
  }
  planning::IsFree is_free() const {
    return [this](const Eigen::VectorXd& q) { return !world.collides(q); };
  }
};

planning::BirrtOptions limits(double overshoot) {
  planning::BirrtOptions options;
  options.step = kStep;
  options.overshoot = overshoot;
  options.max_checks = kMaxPlanChecks;
  options.time_limit = std::chrono::seconds(600);
  return options;
}

Attempt run_cbirrt2(const Carrying& carrying, double overshoot, std::uint64_t seed) {
  planning::RegionConstraint constraint = carrying.constraint();
  std::mt19937_64 generator(seed);
  return attempt_of(planning::plan_cbirrt2(
      carrying.instance.start, carrying.instance.goals, {carrying.is_free(), constraint},
      planning::ConfigurationSampler(carrying.bounds), limits(overshoot), generator));
}

/// \param range  of one extension, joint units; 0: OMPL's choice.
Attempt run_rrt_connect(const Carrying& carrying, double range, std::uint64_t seed) {
  ompl::RNG::setSeed(seed + 1);
  planning::RegionConstraint constraint = carrying.constraint();
  std::mt19937_64 generator(seed);
  return attempt_of(planning::plan_with_ompl(
      carrying.instance.start, carrying.instance.goals, {carrying.is_free(), constraint},
      planning::ConfigurationSampler(carrying.bounds),
      {.planner = "RRTConnect", .range = range, .limits = limits(1)}, generator));
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

int run(const std::string& robot, int instances) {
  const kinematics::Chain chain = test::model_chain(robot);
  const geometry::RobotShapes shapes = model_shapes(robot);
  std::vector<std::vector<Attempt>> attempts(5);
  for (int i = 0; i < instances; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    std::mt19937_64 generator(seed);
    const test::CarryingCell cell = test::make_carrying_cell(chain, generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
    const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_pick, middle);
    if (starts.cols() == 0)
      continue;
    const Eigen::VectorXd start = starts.col(0);
    const Carrying carrying = {
        chain,
        world,
        cell.upright,
        {start, place_configurations(chain, world, cell.T_base_place, start)},
        planning::planning_bounds(chain, start)};
    if (carrying.instance.goals.cols() == 0)
      continue;
    attempts[0].push_back(run_cbirrt2(carrying, 1.0, seed));
    attempts[1].push_back(run_cbirrt2(carrying, 1.5, seed));
    attempts[2].push_back(run_rrt_connect(carrying, 0, seed));
    attempts[3].push_back(run_rrt_connect(carrying, 0.5, seed));
    attempts[4].push_back(run_rrt_connect(carrying, 1.5, seed));
    std::cerr << "instance " << i;
    for (const auto& of_planner : attempts)
      std::cerr << "  " << of_planner.back().checks;
    std::cerr << '\n';
  }
  std::cout << robot << ", " << attempts[0].size() << " of " << instances << " instances, step "
            << kStep << ", at most " << kMaxPlanChecks << " checks\n";
  print_header();
  print("CBiRRT2, overshoot 1", attempts[0]);
  print("CBiRRT2, overshoot 1.5", attempts[1]);
  print("RRTConnect, range of OMPL", attempts[2]);
  print("RRTConnect, range 0.5", attempts[3]);
  print("RRTConnect, range 1.5", attempts[4]);
  return attempts[0].empty() ? 1 : 0;
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  return kinship::bench::run(argc > 1 ? argv[1] : "panda", argc > 2 ? std::atoi(argv[2]) : 50);
}
