// Collision checks of the Repetition Roadmap against guided and uniform BiRRT on the same instances
// of the planar cell; the mixture is fitted to the robot's own paths of other instances.
// Usage: roadmap_bench [INSTANCES] [PATHS] [ROBOT...]

#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "client/planning/path_vertices.hpp"
#include "client/planning/repetition_roadmap.hpp"
#include "client/planning/shortcut.hpp"
#include "server/density/fit.hpp"
#include "tests/bench/planar_cell.hpp"
#include "tests/bench/planning_attempts.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kLearningSeed = 1'000'000, kTestSeed = 9'000'000;
constexpr std::uint64_t kMaxChecks = 60'000;
constexpr double kStep = 0.05, kSpacing = 0.3, kShare = 0.9;

/// One query of the cell with everything a planner needs.
struct Cell {
  Cell(const PlanarRobot& arm, const Eigen::VectorXd& nominal, std::uint64_t cell_seed)
      : robot(arm),
        seed(cell_seed),
        cell(make_planar_cell(robot.chain, seed)),
        world(robot.chain, robot.shapes, cell.surroundings),
        query(make_query(robot, cell, world, nominal, seed)) {
    if (query)
      bounds = planning::planning_bounds(robot.chain, query->start);
  }

  planning::IsFree is_free() {
    return [this](const Eigen::VectorXd& q) { return !world.collides(q); };
  }

  const PlanarRobot& robot;
  std::uint64_t seed;
  PlanarCell cell;
  collision::CollisionWorld world;
  std::optional<PlanarQuery> query;
  Eigen::Matrix2Xd bounds;
};

planning::BirrtOptions tree_options(double overshoot) {
  return {.step = kStep,
          .overshoot = overshoot,
          .max_checks = kMaxChecks,
          .time_limit = std::chrono::seconds(3600)};
}

planning::PlanSummary run_birrt(Cell& cell, const planning::ConfigurationSampler& sampler,
                                double overshoot) {
  std::mt19937_64 generator(cell.seed + 77);
  return planning::plan_birrt(cell.query->start, cell.query->goals, cell.is_free(), sampler,
                              tree_options(overshoot), generator);
}

planning::PlanSummary run_roadmap(Cell& cell, const planning::ConfigurationSampler& sampler,
                                  std::uint64_t max_roadmap_checks) {
  std::mt19937_64 generator(cell.seed + 77);
  planning::RoadmapOptions options;
  options.tree = tree_options(2);
  options.max_roadmap_checks = max_roadmap_checks;
  return planning::plan_roadmap(cell.query->start, cell.query->goals, cell.is_free(), sampler,
                                options, generator);
}

/// Fitted to shortened paths, every path weighing the same.
Mixture learn(const PlanarRobot& robot, const Eigen::VectorXd& nominal, int paths) {
  std::vector<Eigen::MatrixXd> recorded;
  Eigen::Index total = 0;
  for (std::uint64_t seed = kLearningSeed; static_cast<int>(recorded.size()) < paths; ++seed) {
    Cell cell(robot, nominal, seed);
    if (!cell.query)
      continue;
    const auto planned = run_birrt(cell, planning::ConfigurationSampler(cell.bounds), 1);
    if (!planned.waypoints)
      continue;
    std::mt19937_64 generator(seed);
    const auto shortened = planning::shortcut(*planned.waypoints, cell.is_free(),
                                              {.step = kStep, .max_checks = 300}, generator);
    recorded.push_back(planning::densified(shortened.waypoints, kSpacing));
    total += recorded.back().cols();
  }
  Eigen::MatrixXd configurations(robot.chain.dof(), total);
  Eigen::VectorXd weights(total);
  Eigen::Index next = 0;
  for (const Eigen::MatrixXd& path : recorded) {
    configurations.middleCols(next, path.cols()) = path;
    weights.segment(next, path.cols()).setConstant(1 / static_cast<double>(path.cols()));
    next += path.cols();
  }
  return density::fit_mixture(configurations, weights, {}).value().mixture;
}

void run(const std::string& name, int instances, int paths) {
  const PlanarRobot robot(name);
  const Eigen::VectorXd nominal = nominal_start(robot);
  const Mixture mixture = learn(robot, nominal, paths);
  std::vector<std::vector<Attempt>> attempts(5);
  int by_roadmap = 0;
  for (std::uint64_t seed = kTestSeed; static_cast<int>(attempts[0].size()) < instances; ++seed) {
    Cell cell(robot, nominal, seed);
    if (!cell.query)
      continue;
    const planning::ConfigurationSampler uniform(cell.bounds);
    const planning::ConfigurationSampler guided(cell.bounds, robot.chain, mixture, kShare);
    attempts[0].push_back(attempt_of(run_birrt(cell, uniform, 1)));
    attempts[1].push_back(attempt_of(run_birrt(cell, uniform, 2)));
    attempts[2].push_back(attempt_of(run_birrt(cell, guided, 2)));
    attempts[3].push_back(attempt_of(run_roadmap(cell, guided, 500)));
    const planning::PlanSummary roadmap = run_roadmap(cell, guided, 2000);
    attempts[4].push_back(attempt_of(roadmap));
    by_roadmap += roadmap.waypoints && roadmap.iterations == 0;
  }
  std::cout << name << ", " << instances << " instances, K = " << mixture.size() << " from "
            << paths << " own paths, step " << kStep << ", at most " << kMaxChecks << " checks; "
            << by_roadmap << " solved by the roadmap of 2000 alone\n";
  print_header();
  print("uniform BiRRT, overshoot 1", attempts[0]);
  print("uniform BiRRT, overshoot 2", attempts[1]);
  print("guided BiRRT, overshoot 2", attempts[2]);
  print("roadmap, 500 checks, trees", attempts[3]);
  print("roadmap, 2000 checks, trees", attempts[4]);
  std::cout << std::flush;
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  const int instances = argc > 1 ? std::atoi(argv[1]) : 40;
  const int paths = argc > 2 ? std::atoi(argv[2]) : 50;
  std::vector<std::string> robots(argv + std::min(argc, 3), argv + argc);
  if (robots.empty())
    robots = {"planar_5r_a", "planar_5r_b", "planar_7r_c"};
  for (const std::string& robot : robots)
    kinship::bench::run(robot, instances, paths);
}
