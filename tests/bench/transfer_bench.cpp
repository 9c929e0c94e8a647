// Transfer between the five cobots: paths of their learning sets, resampled, from each to each
// other, on two threads, without filters; by tracks (the default profile) and by random solutions
// alone (L = 8, d = 0.2). Configurations per second of wall clock.
//
//   transfer_bench

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/transfer/transfer.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/learning_sets.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/robots.hpp"

namespace kinship::bench {
namespace {

constexpr std::size_t kPaths = 100;  // a pair
constexpr int kThreads = 2;
constexpr std::size_t kGroup = 16;

struct Teacher {
  std::string name;
  kinematics::Chain chain;
  Eigen::Isometry3d T_task_base;
  std::vector<Path> paths;
};

std::vector<Teacher> teachers() {
  std::vector<Teacher> result;
  for (const std::string& name : cobots()) {
    const LearningSet set = read_learning_set(name);
    Teacher teacher{name, test::model_chain(name), set.solved.front().T_task_base.value(), {}};
    for (std::size_t i = 0; i < std::min(kPaths, set.solved.size()); ++i)
      teacher.paths.push_back(set.solved[i].path.value());
    result.push_back(std::move(teacher));
  }
  return result;
}

struct Rate {
  double per_s = 0;
  double solved_share = 0;  ///< of the poses
};

/// Threads take groups of paths in turn, as the server does.
Rate transfer_pair(const Teacher& source, const Teacher& target,
                   const TransferParameters& parameters) {
  const transfer::ArmPair pair(source.chain, target.chain);
  const Eigen::Isometry3d T_target_source = target.T_task_base.inverse() * source.T_task_base;
  const transfer::Filters none;
  std::vector<TransferCounts> sums(kThreads);
  const auto work = [&](std::size_t thread) {
    for (std::size_t first = thread * kGroup; first < source.paths.size();
         first += kThreads * kGroup) {
      std::vector<transfer::PathToTransfer> group;
      for (std::size_t i = first; i < std::min(first + kGroup, source.paths.size()); ++i)
        group.push_back({source.paths[i], T_target_source, none});
      for (const auto& path : transfer::transfer_paths(group, pair, parameters, 0))
        sums[thread] += path.summary;
    }
  };
  const double start_s = wall_s();
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kThreads; ++i)
      threads.emplace_back(work, i);
  }
  const double taken_s = wall_s() - start_s;
  sums[0] += sums[1];
  return {static_cast<double>(sums[0].configurations) / taken_s,
          static_cast<double>(sums[0].poses_solved) / static_cast<double>(sums[0].poses)};
}

struct Way {
  std::string name;
  TransferParameters parameters;
  std::optional<double> budget_per_s;
};

void measure(const std::vector<Teacher>& robots, const Way& way) {
  double sum = 0, solved = 0, least = std::numeric_limits<double>::infinity();
  std::string slowest;
  int pairs = 0;
  for (const Teacher& source : robots)
    for (const Teacher& target : robots) {
      if (&source == &target)
        continue;
      const Rate rate = transfer_pair(source, target, way.parameters);
      sum += rate.per_s;
      solved += rate.solved_share;
      if (rate.per_s < least) {
        least = rate.per_s;
        slowest = source.name + " to " + target.name;
      }
      ++pairs;
    }
  print({.name = way.name + ", mean of " + std::to_string(pairs) + " pairs",
         .value = sum / pairs,
         .unit = "configurations/s",
         .better = Better::Higher,
         .budget = way.budget_per_s,
         .note = std::to_string(std::lround(100 * solved / pairs)) + " % of the poses solved"});
  print({.name = way.name + ", slowest pair",
         .value = least,
         .unit = "configurations/s",
         .better = Better::Higher,
         .note = slowest});
}

}  // namespace
}  // namespace kinship::bench

int main() {
  using namespace kinship::bench;
  const std::vector<Teacher> robots = teachers();
  measure(robots, {"tracks", {}, 300e3});
  measure(robots, {"random solutions", {.max_solutions = 8, .min_distance = 0.2, .tracks = 0}, {}});
}
