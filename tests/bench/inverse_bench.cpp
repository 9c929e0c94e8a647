#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/robots.hpp"

// Inverse kinematics of the model robots at reachable poses (L = 8, d = 0.2): time per pose,
// solutions per pose, share of poses without any.
namespace kinship {
namespace {

std::vector<Eigen::Isometry3d> reachable_poses(const kinematics::Chain& chain, int count) {
  std::mt19937_64 generator(1);
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < count; ++i) {
    const Eigen::VectorXd q = test::random_configuration(chain, generator);
    poses.push_back(kinematics::T_base_tip(chain, q));
  }
  return poses;
}

void inverse_of_model(benchmark::State& state, const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  const std::vector<Eigen::Isometry3d> poses = reachable_poses(chain, 2000);
  const inverse::InverseOptions options{.max_solutions = 8, .min_distance = 0.2};
  std::size_t next = 0;
  double solutions = 0;
  double without = 0;
  for (auto step : state) {
    const auto found = inverse::inverse(chain, poses[next], options);
    next = (next + 1) % poses.size();
    solutions += static_cast<double>(found.configurations.cols());
    without += found.configurations.cols() == 0 ? 1 : 0;
  }
  state.counters["solutions/pose"] =
      benchmark::Counter(solutions, benchmark::Counter::kAvgIterations);
  state.counters["without"] = benchmark::Counter(without, benchmark::Counter::kAvgIterations);
  state.counters["solutions/s"] = benchmark::Counter(solutions, benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(inverse_of_model, panda, std::string("panda"))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(inverse_of_model, iiwa14, std::string("iiwa14"))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(inverse_of_model, ur10e, std::string("ur10e"))->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kinship

BENCHMARK_MAIN();
