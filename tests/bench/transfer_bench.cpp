#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include "server/transfer/transfer.hpp"
#include "tests/support/robots.hpp"

// Transfer of random paths between model robots that stand at the same place, with the default
// profile (L = 5, d = 0.5): time per path, configurations per second, share of poses solved.
namespace kinship {
namespace {

std::vector<Path> random_paths(const kinematics::Chain& chain, int count) {
  std::mt19937_64 generator(1);
  std::vector<Path> paths;
  for (int i = 0; i < count; ++i) {
    Eigen::MatrixXd waypoints(chain.dof(), 3);
    for (Eigen::Index column = 0; column < waypoints.cols(); ++column)
      waypoints.col(column) = test::random_configuration(chain, generator);
    paths.emplace_back(waypoints);
  }
  return paths;
}

void transfer_pair(benchmark::State& state, const std::string& from, const std::string& to) {
  const kinematics::Chain source = test::model_chain(from);
  const kinematics::Chain target = test::model_chain(to);
  const std::vector<Path> paths = random_paths(source, 50);
  const transfer::ArmPair pair(source, target);
  std::size_t next = 0;
  double configurations = 0;
  double poses = 0;
  double solved = 0;
  for (auto step : state) {
    const auto moved =
        transfer::transfer_path(paths[next], pair, Eigen::Isometry3d::Identity(), {}, 0);
    next = (next + 1) % paths.size();
    configurations += static_cast<double>(moved.summary.configurations);
    poses += static_cast<double>(moved.summary.poses);
    solved += static_cast<double>(moved.summary.poses_solved);
  }
  state.counters["configurations/s"] =
      benchmark::Counter(configurations, benchmark::Counter::kIsRate);
  state.counters["poses/s"] = benchmark::Counter(poses, benchmark::Counter::kIsRate);
  state.counters["solved"] = solved / poses;
}

BENCHMARK_CAPTURE(transfer_pair, panda_to_iiwa14, std::string("panda"), std::string("iiwa14"));
BENCHMARK_CAPTURE(transfer_pair, panda_to_ur10e, std::string("panda"), std::string("ur10e"));
BENCHMARK_CAPTURE(transfer_pair, iiwa14_to_panda, std::string("iiwa14"), std::string("panda"));
BENCHMARK_CAPTURE(transfer_pair, iiwa14_to_ur10e, std::string("iiwa14"), std::string("ur10e"));
BENCHMARK_CAPTURE(transfer_pair, ur10e_to_panda, std::string("ur10e"), std::string("panda"));
BENCHMARK_CAPTURE(transfer_pair, ur10e_to_iiwa14, std::string("ur10e"), std::string("iiwa14"));

}  // namespace
}  // namespace kinship

BENCHMARK_MAIN();
