#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "robots/inverse/inverse.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "server/transfer/transfer.hpp"
#include "tests/support/robots.hpp"

// Transfer of paths between model robots that stand at the same place, with the default profile
// (tracks, random solutions where they are missing) and with random solutions alone (L = 5,
// d = 0.5): poses and configurations per second, share of poses solved, of tracks kept, of random
// configurations. `random` paths cross the whole joint range; `near` ones stay within 0.8 of a
// configuration that the target reaches too, as paths of a shared task do.
namespace kinship {
namespace {

constexpr std::size_t kGroup = 16;  // paths that are transferred at once, as the server does

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

/// Paths around configurations whose pose the target reaches.
std::vector<Path> near_paths(const kinematics::Chain& source, const kinematics::Chain& target,
                             int count) {
  std::mt19937_64 generator(1);
  std::vector<Path> paths;
  while (static_cast<int>(paths.size()) < count) {
    const Eigen::VectorXd middle = test::random_configuration(source, generator);
    const Eigen::Isometry3d T_base_tip =
        kinematics::T_base_transfer(source, middle) * target.T_tip_transfer().inverse();
    if (inverse::inverse(target, T_base_tip, {.max_solutions = 1}).configurations.cols() == 0)
      continue;
    Eigen::MatrixXd waypoints(source.dof(), 3);
    for (Eigen::Index column = 0; column < waypoints.cols(); ++column)
      waypoints.col(column) =
          middle + (test::random_configuration(source, generator) - middle).normalized() * 0.8;
    paths.emplace_back(waypoints);
  }
  return paths;
}

void transfer_pair(benchmark::State& state, const std::string& from, const std::string& to,
                   bool near, int tracks) {
  const kinematics::Chain source = test::model_chain(from);
  const kinematics::Chain target = test::model_chain(to);
  const std::vector<Path> paths = near ? near_paths(source, target, 50) : random_paths(source, 50);
  const transfer::ArmPair pair(source, target);
  const TransferParameters parameters{.tracks = tracks};
  const transfer::Filters none;
  std::size_t next = 0;
  TransferCounts sum;
  for (auto step : state) {
    std::vector<transfer::PathToTransfer> group;
    for (; group.size() < kGroup; next = (next + 1) % paths.size())
      group.push_back({paths[next], Eigen::Isometry3d::Identity(), none});
    for (const auto& path : transfer::transfer_paths(group, pair, parameters, 0))
      sum += path.summary;
  }
  const auto rate = [](std::uint64_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsRate);
  };
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(whole, 1));
  };
  state.counters["poses/s"] = rate(sum.poses);
  state.counters["configurations/s"] = rate(sum.configurations);
  state.counters["solved"] = share(sum.poses_solved, sum.poses);
  state.counters["tracks"] = share(sum.tracks_kept, sum.tracks_tried);
  state.counters["random"] = share(sum.random_configurations, sum.configurations);
}

void add_pairs() {
  const std::vector<std::pair<std::string, std::string>> pairs = {{"panda", "iiwa14"},
                                                                  {"panda", "ur10e"},
                                                                  {"iiwa14", "panda"},
                                                                  {"iiwa14", "ur10e"},
                                                                  {"ur10e", "panda"},
                                                                  {"ur10e", "iiwa14"},
                                                                  {"planar_5r_a", "planar_7r_c"},
                                                                  {"planar_7r_c", "planar_5r_a"}};
  for (const auto& [from, to] : pairs)
    for (const bool near : {false, true})
      for (const int tracks : {0, 3}) {
        const std::string name = from + "_to_" + to + (near ? "/near" : "/random") +
                                 (tracks > 0 ? "/tracks" : "/random_solutions");
        benchmark::RegisterBenchmark(name.c_str(), transfer_pair, from, to, near, tracks);
      }
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  kinship::add_pairs();
  benchmark::RunSpecifiedBenchmarks();
}
