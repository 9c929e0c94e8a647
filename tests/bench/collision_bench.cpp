// Collision checks a second in the shelf cell: 12 boxes, gripper, a held box. One thread, CPU time.
// Meshes: the Panda with a mesh in the place of each solid, among boxes, meshes, and the points of
// a camera; also what its world costs, and a plan in it.
//
//   collision_bench boxes | meshes

#include <unistd.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "robots/geometry/point_cloud.hpp"
#include "robots/planning/birrt.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/processor.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/bench/surface_meshes.hpp"
#include "tests/support/process_figures.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr Eigen::Index kConfigurations = 2000;
constexpr double kSpread_rad = 0.1;

/// Of checks side by side: as many as if each took so many multiply-adds; 0: to FCL, without one.
struct Budgets {
  int runs = 5;
  double free = 0, near = 0;
};

/// Configurations around the free starts; without those that collide if only free ones are wanted.
Eigen::MatrixXd configurations_near_start(const kinematics::Chain& chain,
                                          collision::CollisionWorld& world,
                                          const Eigen::MatrixXd& starts, bool only_free) {
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal(0, kSpread_rad);
  Eigen::MatrixXd found(chain.dof(), kConfigurations);
  for (Eigen::Index i = 0, count = 0; count < kConfigurations; ++i) {
    const Eigen::VectorXd q =
        starts.col(i % starts.cols()) +
        Eigen::VectorXd::NullaryExpr(chain.dof(), [&] { return normal(generator); });
    if (!only_free || !world.collides(q))
      found.col(count++) = q;
  }
  return found;
}

/// Checks a second of FCL, one configuration after the other.
double fcl_rate(collision::CollisionWorld& world, const Eigen::MatrixXd& asked) {
  std::size_t colliding = 0;
  const double taken_s = least_s(5, thread_cpu_s, [&] {
    for (Eigen::Index i = 0; i < asked.cols(); ++i)
      colliding += world.find_contact(asked.col(i)) ? 1U : 0U;
  });
  return static_cast<double>(asked.cols()) / taken_s;
}

/// Asks for all, `together` at once; what comes after a colliding one is asked again.
std::size_t count_colliding(collision::CollisionWorld& world, const Eigen::MatrixXd& asked,
                            Eigen::Index together) {
  std::size_t colliding = 0;
  for (Eigen::Index first = 0; first < asked.cols();) {
    const Eigen::Index count = std::min(together, asked.cols() - first);
    const Eigen::Index free = world.free_ahead(asked.middleCols(first, count));
    colliding += free < count ? 1U : 0U;
    first += std::min(free + 1, count);
  }
  return colliding;
}

/// Checks near the starts, beside FCL.
void check(const std::string& name, const kinematics::Chain& chain,
           collision::CollisionWorld& world, const Eigen::MatrixXd& starts,
           const Budgets& budgets) {
  for (const bool only_free : {true, false}) {
    const Eigen::MatrixXd asked = configurations_near_start(chain, world, starts, only_free);
    const Reference fcl{"FCL", fcl_rate(world, asked)};
    for (const Eigen::Index together : {1, 16}) {
      std::size_t colliding = 0;
      const double taken_s = least_s(budgets.runs, thread_cpu_s,
                                     [&] { colliding = count_colliding(world, asked, together); });
      Figure figure{
          .name = name + (only_free ? ", free" : ", near a start") +
                  (together > 1 ? ", side by side" : ""),
          .value = static_cast<double>(asked.cols()) / taken_s,
          .unit = "checks/s",
          .better = Better::Higher,
          .reference = fcl,
          .note = std::to_string(100 * colliding / static_cast<std::size_t>(kConfigurations)) +
                  " % colliding"};
      if (const double each = only_free ? budgets.free : budgets.near; together > 1 && each > 0) {
        figure.reference = rate_at_best(each);
        figure.ratio_budget = 1;
      } else if (together > 1 && only_free) {
        figure.ratio_budget = 10;
      }
      print(figure);
    }
  }
}

Eigen::MatrixXd starts_in(const kinematics::Chain& chain, collision::CollisionWorld& world,
                          const ShelfCell& cell) {
  return free_configurations(chain, world, cell.T_base_start, (chain.lower() + chain.upper()) / 2);
}

void check_among_boxes(const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  std::mt19937_64 generator(kSeed);
  const ShelfCell cell = make_shelf_cell(chain, generator);
  collision::CollisionWorld world(chain, model_shapes(robot), cell.surroundings);
  check(robot, chain, world, starts_in(chain, world, cell), {.runs = 20});
}

/// The mean CPU time of a plan by BiRRT from the table into the shelf, s.
double plan_s(const kinematics::Chain& chain, collision::CollisionWorld& world,
              const Eigen::VectorXd& start, const Eigen::MatrixXd& goals) {
  constexpr int kPlans = 20;
  const planning::ConfigurationSampler sampler(planning::planning_bounds(chain, start));
  const double begin_s = thread_cpu_s();
  for (std::uint64_t seed = 0; seed < kPlans; ++seed) {
    std::mt19937_64 generator(seed);
    planning::BirrtOptions options;
    options.overshoot = 1;
    options.max_checks = 200'000;
    if (!planning::plan_birrt(start, goals, planning::free_in(world), sampler, options, generator)
             .waypoints)
      throw std::runtime_error("no path");
  }
  return (thread_cpu_s() - begin_s) / kPlans;
}

/// What the Panda of meshes meets.
struct Surface {
  std::string name;
  std::function<Scene()> make;  ///< its time counts for the world's
  Budgets budgets;
};

std::vector<Surface> surfaces(const Scene& boxes) {
  const auto cloud = [&boxes](Eigen::Index count) {
    std::mt19937_64 generator(kSeed);
    const auto points =
        std::make_shared<const Eigen::Matrix3Xd>(surface_points(boxes, count, generator));
    return [points] {
      SceneCloud seen;
      seen.name = "camera";
      seen.cloud.voxels = std::make_shared<const Eigen::Matrix3Xd>(
          geometry::voxels_of(*points, seen.cloud.voxel_m).value_or_throw());
      Scene scene;
      scene.clouds.push_back(std::move(seen));
      return scene;
    };
  };
  return {{"boxes", [&boxes] { return boxes; }, {.free = 23e3, .near = 140e3}},
          {"meshes of 1600 triangles",
           [scene = as_meshes(boxes, 20)] { return scene; },
           {.free = 70e3, .near = 140e3}},
          {"100 000 points", cloud(100'000), {.free = 70e3, .near = 140e3}},
          {"1 000 000 points", cloud(1'000'000), {.free = 70e3, .near = 140e3}}};
}

void check_among(const Surface& surface, const kinematics::Chain& chain, const ShelfCell& cell,
                 const collision::RobotSolids& robot, double primitives_s) {
  collision::Surroundings surroundings = cell.surroundings;
  std::optional<collision::CollisionWorld> world;
  const double before_mb = test::figures_of(getpid()).resident_mb;
  const double made_s = least_s(3, thread_cpu_s, [&] {
    surroundings.scene = surface.make();
    world.emplace(robot, surroundings);
  });
  const double taken_mb = test::figures_of(getpid()).resident_mb - before_mb;
  const std::string name = "panda of meshes among " + surface.name;
  print({.name = name + ", the world made",
         .value = 1e3 * made_s,
         .unit = "ms",
         .reference = time_at_best(10.5e9, 1e-3),
         .ratio_budget = 1,
         .note = std::to_string(std::lround(taken_mb)) + " MB"});
  const Eigen::MatrixXd starts = starts_in(chain, *world, cell);
  check(name, chain, *world, starts, surface.budgets);
  const Eigen::MatrixXd goals = free_configurations(chain, *world, cell.T_base_goal, starts.col(0));
  print({.name = name + ", a plan",
         .value = 1e3 * plan_s(chain, *world, starts.col(0), goals),
         .unit = "ms",
         .reference = Reference{"with primitive shapes", 1e3 * primitives_s},
         .ratio_budget = 3});
}

void check_meshes() {
  const kinematics::Chain chain = test::model_chain("panda");
  std::mt19937_64 generator(kSeed);
  const ShelfCell cell = make_shelf_cell(chain, generator);
  const geometry::RobotShapes primitives = model_shapes("panda");
  collision::CollisionWorld among_boxes(chain, primitives, cell.surroundings);
  const Eigen::VectorXd start = starts_in(chain, among_boxes, cell).col(0);
  const double primitives_s = plan_s(
      chain, among_boxes, start, free_configurations(chain, among_boxes, cell.T_base_goal, start));
  const collision::RobotSolids robot(chain, with_meshes(primitives, 20));
  for (const Surface& surface : surfaces(cell.surroundings.scene))
    check_among(surface, chain, cell, robot, primitives_s);
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  const std::string scene = argc > 1 ? argv[1] : "";
  if (scene == "boxes")
    for (const char* robot : {"panda", "iiwa14", "ur10e"})
      kinship::bench::check_among_boxes(robot);
  else if (scene == "meshes")
    kinship::bench::check_meshes();
  else
    std::cerr << "usage: collision_bench boxes | meshes\n";
  return scene == "boxes" || scene == "meshes" ? 0 : 2;
}
