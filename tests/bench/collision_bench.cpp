// Collision checks a second in the shelf cell: 12 boxes, gripper, a held box. One thread, CPU time.
// Meshes: the Panda with a mesh in the place of each solid, among boxes, meshes, the points of a
// camera, and an OctoMap; also what its world costs, and a plan in it. The cubes of points and of
// the OctoMap stand beside one OcTree of FCL.
//
//   collision_bench boxes | meshes

#include <algorithm>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "robots/geometry/point_cloud.hpp"
#include "robots/geometry/point_file.hpp"
#include "robots/planning/birrt.hpp"
#include "tests/bench/fcl_world.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/processor.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/bench/surface_meshes.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr Eigen::Index kConfigurations = 2000;
constexpr double kSpread_rad = 0.1;
const std::string kOneOcTree = "FCL, one OcTree";

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

/// How a reference answers about one configuration.
struct Peer {
  std::string name;
  int runs = 5;
  std::function<bool(const Eigen::VectorXd&)> collides;
};

Peer fcl_of(collision::CollisionWorld& world) {
  return {"FCL", 5,
          [&world](const Eigen::VectorXd& q) { return world.find_contact(q).has_value(); }};
}

/// Checks a second, one configuration after the other.
double rate_of(const Peer& peer, const Eigen::MatrixXd& asked, std::size_t& colliding) {
  const double taken_s = least_s(peer.runs, thread_cpu_s, [&] {
    colliding = 0;
    for (Eigen::Index i = 0; i < asked.cols(); ++i)
      colliding += peer.collides(asked.col(i)) ? 1U : 0U;
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
           collision::CollisionWorld& world, const Eigen::MatrixXd& starts, const Peer& peer,
           const Budgets& budgets) {
  for (const bool only_free : {true, false}) {
    const Eigen::MatrixXd asked = configurations_near_start(chain, world, starts, only_free);
    std::size_t colliding = 0, colliding_there = 0;
    const Reference reference{peer.name, rate_of(peer, asked, colliding_there)};
    for (const Eigen::Index together : {1, 16}) {
      const double taken_s = least_s(budgets.runs, thread_cpu_s,
                                     [&] { colliding = count_colliding(world, asked, together); });
      if (colliding != colliding_there)
        throw std::runtime_error(name + ": " + std::to_string(colliding) + " collide, " +
                                 peer.name + " says " + std::to_string(colliding_there));
      Figure figure{
          .name = name + (only_free ? ", free" : ", near a start") +
                  (together > 1 ? ", side by side" : ""),
          .value = static_cast<double>(asked.cols()) / taken_s,
          .unit = "checks/s",
          .better = Better::Higher,
          .reference = reference,
          .note = std::to_string(100 * colliding / static_cast<std::size_t>(kConfigurations)) +
                  " % colliding"};
      if (const double each = only_free ? budgets.free : budgets.near; together > 1 && each > 0) {
        figure.note +=
            "; " + std::to_string(std::lround(figure.value / reference.value)) + " x " + peer.name;
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
  check(robot, chain, world, starts_in(chain, world, cell), fcl_of(world), {.runs = 20});
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
  std::function<std::shared_ptr<const octomap::OcTree>()> make_map = {};  ///< the same for FCL
};

Scene cloud_scene(const geometry::FilePoints& points) {
  SceneCloud seen;
  seen.name = "camera";
  if (points.cube_m > 0)
    seen.cloud.voxel_m = points.cube_m;
  seen.cloud.voxels = std::make_shared<const Eigen::Matrix3Xd>(
      geometry::voxels_of(points.points, seen.cloud.voxel_m).value_or_throw());
  Scene scene;
  scene.clouds.push_back(std::move(seen));
  return scene;
}

std::vector<Surface> surfaces(const Scene& boxes) {
  const Budgets budgets{.free = 70e3, .near = 140e3};
  const auto seen = [&boxes](Eigen::Index count) {
    std::mt19937_64 generator(kSeed);
    return surface_points(boxes, count, generator);
  };
  const auto cloud = [&](const std::string& name, Eigen::Index count) {
    const auto points =
        std::make_shared<const geometry::FilePoints>(geometry::FilePoints{seen(count)});
    return Surface{name, [points] { return cloud_scene(*points); }, budgets,
                   [points] { return map_of(points->points, PointCloud{}.voxel_m); }};
  };
  std::ostringstream file;
  map_of(seen(100'000), PointCloud{}.voxel_m)->writeBinaryConst(file);
  const std::string text = file.str();
  return {{"boxes", [&boxes] { return boxes; }, {.free = 23e3, .near = 140e3}},
          {"meshes of 1600 triangles", [scene = as_meshes(boxes, 20)] { return scene; }, budgets},
          cloud("100 000 points", 100'000),
          cloud("1 000 000 points", 1'000'000),
          {"an OctoMap", [text] { return cloud_scene(geometry::read_octomap(text)); }, budgets,
           [text] {
             auto map = std::make_shared<octomap::OcTree>(PointCloud{}.voxel_m);
             std::istringstream stream(text);
             if (!map->readBinary(stream))
               throw std::runtime_error("OctoMap does not read its own file");
             return map;
           }}};
}

/// CPU time and memory of making something, the last of which is kept.
struct Making {
  double ms = 0, mb = 0;

  Making(const std::function<void()>& forget, const std::function<void()>& make) {
    constexpr int kTimes = 3;
    double least_ms = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kTimes; ++i) {
      forget();
      const double before_mb = heap_mb();
      least_ms = std::min(least_ms, 1e3 * least_s(1, thread_cpu_s, make));
      mb = heap_mb() - before_mb;
    }
    ms = least_ms;
  }
};

void print_making(const std::string& name, const Making& ours, const Making* fcl) {
  print({.name = name + ", the world made",
         .value = ours.ms,
         .unit = "ms",
         .reference = time_at_best(10.5e9, 1e-3),
         .ratio_budget = 1,
         .note = std::to_string(std::lround(ours.mb)) + " MB"});
  if (fcl == nullptr)
    return;
  print({.name = name + ", the world made, to FCL",
         .value = ours.ms,
         .unit = "ms",
         .reference = Reference{kOneOcTree, fcl->ms}});
  print({.name = name + ", memory",
         .value = ours.mb,
         .unit = "MB",
         .reference = Reference{kOneOcTree, fcl->mb}});
}

/// The Panda of meshes in the cell.
struct Subject {
  const kinematics::Chain& chain;
  const ShelfCell& cell;
  const geometry::RobotShapes shapes;
  const collision::RobotSolids robot;
  double primitives_s;  ///< a plan with primitive shapes
};

void check_among(const Surface& surface, const Subject& subject) {
  collision::Surroundings around = subject.cell.surroundings;
  around.scene = {};
  std::shared_ptr<fcl::OcTree<double>> tree;
  std::optional<OctreeWorld> by_fcl;
  std::optional<Making> fcl;
  if (surface.make_map) {
    fcl.emplace([&] { tree.reset(); }, [&] { tree = fcl_octree(surface.make_map()); });
    by_fcl.emplace(subject.robot, subject.shapes, around, tree);
  }
  std::optional<collision::CollisionWorld> world;
  const Making ours(
      [&] {
        world.reset();
        around.scene = {};
      },
      [&] {
        around.scene = surface.make();
        world.emplace(subject.robot, around);
      });
  const std::string name = "panda of meshes among " + surface.name;
  print_making(name, ours, fcl ? &*fcl : nullptr);
  const Eigen::MatrixXd starts = starts_in(subject.chain, *world, subject.cell);
  const Peer peer = by_fcl ? Peer{kOneOcTree, 1, [&](const auto& q) { return by_fcl->collides(q); }}
                           : fcl_of(*world);
  check(name, subject.chain, *world, starts, peer, surface.budgets);
  const Eigen::MatrixXd goals =
      free_configurations(subject.chain, *world, subject.cell.T_base_goal, starts.col(0));
  print({.name = name + ", a plan",
         .value = 1e3 * plan_s(subject.chain, *world, starts.col(0), goals),
         .unit = "ms",
         .reference = Reference{"with primitive shapes", 1e3 * subject.primitives_s},
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
  const geometry::RobotShapes meshes = with_meshes(primitives, 20);
  const Subject subject{chain, cell, meshes, {chain, meshes}, primitives_s};
  for (const Surface& surface : surfaces(cell.surroundings.scene))
    check_among(surface, subject);
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
