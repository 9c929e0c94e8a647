// What the ways of transferring paths are worth to a planner: collision checks of a uniform and of
// a guided BiRRT between the planar arms of robots/models in the planar cell, for each pair of
// source and target and each set of transfer parameters. Same instances, goals and options.
// Usage: guidance_bench [INSTANCES] [PATHS]

#include <cmath>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <vector>

#include "client/planning/birrt.hpp"
#include "client/planning/shortcut.hpp"
#include "server/density/fit.hpp"
#include "server/transfer/collision_filter.hpp"
#include "tests/bench/planar_cell.hpp"
#include "tests/support/transfer_path.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kMaxChecks = 60'000;  // an unsolved query counts that
constexpr std::uint64_t kLearningSeed = 1'000'000;
constexpr std::uint64_t kTestSeed = 9'000'000;

struct Variant {
  std::string name;
  TransferParameters parameters;
};

/// A recorded path and the seed of its cell.
struct Recorded {
  Path path;
  std::uint64_t seed = 0;
};

struct Planned {
  std::optional<Eigen::MatrixXd> waypoints;
  double checks = 0;
};

struct PlanSetup {
  double overshoot = 2;
  std::uint64_t shortcut_checks = 0;
};

std::optional<Planned> plan(const PlanarRobot& robot, const Eigen::VectorXd& nominal,
                            const Mixture* mixture, const PlanSetup& setup, std::uint64_t seed) {
  const PlanarCell cell = make_planar_cell(robot.chain, seed);
  collision::CollisionWorld world(robot.chain, robot.shapes, cell.surroundings);
  const auto query = make_query(robot, cell, world, nominal, seed);
  if (!query)
    return std::nullopt;
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(robot.chain, query->start);
  const planning::ConfigurationSampler sampler =
      mixture ? planning::ConfigurationSampler(bounds, robot.chain, *mixture, 0.9)
              : planning::ConfigurationSampler(bounds);
  const auto is_free = [&](const Eigen::VectorXd& q) { return !world.collides(q); };
  std::mt19937_64 generator(seed + 77);
  auto summary = planning::plan_birrt(query->start, query->goals, is_free, sampler,
                                      {.step = 0.05,
                                       .overshoot = setup.overshoot,
                                       .max_checks = kMaxChecks,
                                       .time_limit = std::chrono::seconds(3600)},
                                      generator);
  Planned planned{std::nullopt, static_cast<double>(summary.collision_checks)};
  if (!summary.waypoints) {
    planned.checks = static_cast<double>(kMaxChecks);
    return planned;
  }
  planned.waypoints =
      planning::shortcut(*summary.waypoints, is_free,
                         {.step = 0.05, .max_checks = setup.shortcut_checks}, generator)
          .waypoints;
  return planned;
}

std::vector<Recorded> record(const PlanarRobot& robot, const Eigen::VectorXd& nominal,
                             std::size_t count) {
  std::vector<Recorded> paths;
  for (std::uint64_t seed = kLearningSeed; paths.size() < count; ++seed)
    if (const auto planned =
            plan(robot, nominal, nullptr, {.overshoot = 1, .shortcut_checks = 300}, seed);
        planned && planned->waypoints)
      paths.push_back({Path(*planned->waypoints), seed});
  return paths;
}

/// The mixture for a target, fitted with every path weighing the same.
std::optional<Mixture> learn(const std::vector<Recorded>& paths, const PlanarRobot& source,
                             const PlanarRobot& target, const TransferParameters& parameters,
                             TransferCounts& summary) {
  const transfer::ArmPair pair(source.chain, target.chain);
  transfer::Filters filters;
  if (parameters.avoid_self_collision)
    filters.self = transfer::collision_filter(target.chain, target.shapes);
  std::vector<transfer::TransferredPath> moved;
  Eigen::Index total = 0;
  for (const Recorded& recorded : paths) {
    if (parameters.avoid_recorded_scene) {
      collision::Surroundings surroundings;
      surroundings.scene = make_planar_cell(source.chain, recorded.seed).surroundings.scene;
      filters.scene = transfer::collision_filter(target.chain, target.shapes, surroundings);
    }
    moved.push_back(test::transfer_path(recorded.path, pair, Eigen::Isometry3d::Identity(),
                                        parameters, 0, filters));
    summary += moved.back().summary;
    total += moved.back().configurations.cols();
  }
  Eigen::MatrixXd configurations(target.chain.dof(), total);
  Eigen::VectorXd weights(total);
  Eigen::Index next = 0;
  for (const auto& path : moved) {
    const Eigen::Index count = path.configurations.cols();
    configurations.middleCols(next, count) = path.configurations;
    weights.segment(next, count)
        .setConstant(1.0 / static_cast<double>(std::max<Eigen::Index>(count, 1)));
    next += count;
  }
  auto fitted = density::fit_mixture(configurations, weights, {});
  if (!fitted)
    return std::nullopt;
  return std::move(fitted).value().mixture;
}

std::vector<Variant> variants() {
  const TransferParameters scenes{};
  TransferParameters tracks = scenes, filtered = scenes, bare = scenes;
  tracks.avoid_recorded_scene = false;
  filtered.avoid_recorded_scene = false;
  filtered.tracks = 0;
  bare = filtered;
  bare.avoid_self_collision = false;
  TransferParameters filtered_scenes = scenes;
  filtered_scenes.tracks = 0;
  return {{"random", bare},
          {"random, self", filtered},
          {"tracks, self", tracks},
          {"random, self, scene", filtered_scenes},
          {"tracks, self, scene", scenes}};
}

double mean_checks(const PlanarRobot& robot, const Eigen::VectorXd& nominal, const Mixture* mixture,
                   int instances, int& unsolved) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = kTestSeed; count < instances; ++seed)
    if (const auto planned = plan(robot, nominal, mixture, {}, seed)) {
      sum += planned->checks;
      unsolved += planned->waypoints ? 0 : 1;
      ++count;
    }
  return sum / count;
}

int run(int instances, std::size_t paths) {
  const std::vector<std::string> names = {"planar_5r_a", "planar_5r_b", "planar_7r_c"};
  std::vector<std::unique_ptr<PlanarRobot>> robots;
  std::vector<Eigen::VectorXd> nominal;
  std::vector<std::vector<Recorded>> recorded;
  std::vector<double> uniform;
  for (const std::string& name : names) {
    robots.push_back(std::make_unique<PlanarRobot>(name));
    nominal.push_back(nominal_start(*robots.back()));
    recorded.push_back(record(*robots.back(), nominal.back(), paths));
    int unsolved = 0;
    uniform.push_back(mean_checks(*robots.back(), nominal.back(), nullptr, instances, unsolved));
    std::cout << name << ": uniform " << uniform.back() << " checks, " << unsolved << " of "
              << instances << " unsolved" << std::endl;
  }
  std::map<std::string, double> logs;
  for (const Variant& variant : variants())
    for (std::size_t target = 0; target < names.size(); ++target)
      for (std::size_t source = 0; source < names.size(); ++source) {
        if (source == target)
          continue;
        TransferCounts summary;
        const auto mixture =
            learn(recorded[source], *robots[source], *robots[target], variant.parameters, summary);
        int unsolved = 0;
        const double guided =
            mixture ? mean_checks(*robots[target], nominal[target], &*mixture, instances, unsolved)
                    : static_cast<double>(kMaxChecks);
        logs[variant.name] += std::log(uniform[target] / guided);
        std::cout << std::fixed << std::setprecision(2) << variant.name << ": " << names[source]
                  << " to " << names[target] << ": ratio " << uniform[target] / guided << ", "
                  << std::setprecision(0) << guided << " checks, " << unsolved << " unsolved, "
                  << summary.poses_solved << " of " << summary.poses << " poses, tracks "
                  << summary.tracks_kept << " of " << summary.tracks_tried << ", random "
                  << summary.random_configurations << " of " << summary.configurations << std::endl;
      }
  for (const Variant& variant : variants())
    std::cout << std::setprecision(2) << variant.name << ": geometric mean "
              << std::exp(logs[variant.name] / 6) << '\n';
  return 0;
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  return kinship::bench::run(argc > 1 ? std::atoi(argv[1]) : 40,
                             argc > 2 ? static_cast<std::size_t>(std::atoi(argv[2])) : 50);
}
