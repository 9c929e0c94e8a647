// Time of one collision check in the shelf cell (12 boxes, gripper and held box).

#include <benchmark/benchmark.h>

#include "tests/bench/shelf_cell.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kSeed = 1;

void check(benchmark::State& state, const std::string& robot, double spread_rad) {
  const kinematics::Chain chain = test::model_chain(robot);
  std::mt19937_64 generator(kSeed);
  const ShelfCell cell = make_shelf_cell(chain, generator);
  collision::CollisionWorld world(chain, model_shapes(robot), cell.surroundings);
  const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
  const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_start, middle);
  if (starts.cols() == 0)
    return state.SkipWithError("no free start");
  std::normal_distribution<double> normal(0, spread_rad);
  std::vector<Eigen::VectorXd> configurations;
  for (int i = 0; i < 2000; ++i)
    configurations.emplace_back(
        starts.col(i % starts.cols()) +
        Eigen::VectorXd::NullaryExpr(chain.dof(), [&] { return normal(generator); }));
  std::size_t index = 0;
  std::uint64_t collisions = 0, checks = 0;
  for (auto _ : state) {
    collisions += world.collides(configurations[index]);
    index = (index + 1) % configurations.size();
    ++checks;
  }
  state.counters["colliding"] = static_cast<double>(collisions) / static_cast<double>(checks);
}

void build_world(benchmark::State& state, const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  const geometry::RobotShapes shapes = model_shapes(robot);
  std::mt19937_64 generator(kSeed);
  const ShelfCell cell = make_shelf_cell(chain, generator);
  for (auto _ : state)
    benchmark::DoNotOptimize(collision::CollisionWorld(chain, shapes, cell.surroundings));
}

BENCHMARK_CAPTURE(check, ur10e_near_start, "ur10e", 0.1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(check, ur10e_anywhere, "ur10e", 1.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(check, panda_near_start, "panda", 0.1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(check, iiwa14_near_start, "iiwa14", 0.1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(build_world, ur10e, "ur10e")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kinship::bench

BENCHMARK_MAIN();
