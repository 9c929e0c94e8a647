// Transfer between the five cobots: paths of their learning sets, resampled, from each to each
// other, on two threads, without filters; by tracks (the default profile) and by random solutions
// alone (L = 8, d = 0.2), in turns. Configurations per second that both threads compute (of CPU
// time, as others may use the machine), whichever way they came: tracks give three a pose, and
// random solutions fill up what they leave.
//
//   transfer_bench

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
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
constexpr int kRuns = 3;  // of each way, of which the fastest counts

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
  double poses_per_s = 0;
  double solved_share = 0;  ///< of the poses
};

/// Each thread takes the next path where it has room for one, as the server's do.
Rate transfer_pair(const Teacher& source, const Teacher& target,
                   const TransferParameters& parameters) {
  const transfer::ArmPair pair(source.chain, target.chain);
  const Eigen::Isometry3d T_target_source = target.T_task_base.inverse() * source.T_task_base;
  const transfer::Filters none;
  std::vector<transfer::PathToTransfer> paths;
  for (const Path& path : source.paths)
    paths.push_back({path, T_target_source, none});
  std::vector<TransferCounts> sums(kThreads);
  std::atomic<std::size_t> next = 0;
  const auto work = [&](std::size_t thread) {
    transfer::transfer_stream(
        {.next =
             [&] {
               const std::size_t i = next++;
               return i < paths.size() ? &paths[i] : nullptr;
             },
         .done = [&](const transfer::PathToTransfer&,
                     const transfer::TransferredPath& path) { sums[thread] += path.summary; }},
        pair, parameters, 0, {});
  };
  const double start_s = process_cpu_s();
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kThreads; ++i)
      threads.emplace_back(work, i);
  }
  const double taken_s = (process_cpu_s() - start_s) / kThreads;
  sums[0] += sums[1];
  return {static_cast<double>(sums[0].configurations) / taken_s,
          static_cast<double>(sums[0].poses) / taken_s,
          static_cast<double>(sums[0].poses_solved) / static_cast<double>(sums[0].poses)};
}

/// One way of transfer, over all pairs.
struct Way {
  std::string name;
  TransferParameters parameters;
  double sum_per_s = 0, sum_poses_per_s = 0, solved_share = 0;
  double least_per_s = std::numeric_limits<double>::infinity();
  std::string slowest = {};

  void add(const Rate& rate, const std::string& pair) {
    sum_per_s += rate.per_s;
    sum_poses_per_s += rate.poses_per_s;
    solved_share += rate.solved_share;
    if (rate.per_s >= least_per_s)
      return;
    least_per_s = rate.per_s;
    slowest = pair;
  }
};

Figure mean(const Way& way, int pairs) {
  return {.name = way.name + ", mean of " + std::to_string(pairs) + " pairs",
          .value = way.sum_per_s / pairs,
          .unit = "configurations/s",
          .better = Better::Higher,
          .note = std::to_string(std::lround(100 * way.solved_share / pairs)) +
                  " % of the poses solved"};
}

Figure slowest(const Way& way) {
  return {.name = way.name + ", slowest pair",
          .value = way.least_per_s,
          .unit = "configurations/s",
          .better = Better::Higher,
          .note = way.slowest};
}

void measure(const std::vector<Teacher>& robots) {
  std::array<Way, 2> ways = {
      Way{"tracks", {}},
      Way{"random solutions", {.max_solutions = 8, .min_distance = 0.2, .tracks = 0}}};
  int pairs = 0;
  for (const Teacher& source : robots)
    for (const Teacher& target : robots) {
      if (&source == &target)
        continue;
      std::array<Rate, 2> best;
      for (int run = 0; run < kRuns; ++run)
        for (std::size_t i = 0; i < ways.size(); ++i) {
          const Rate rate = transfer_pair(source, target, ways[i].parameters);
          if (rate.per_s > best[i].per_s)
            best[i] = rate;
        }
      for (std::size_t i = 0; i < ways.size(); ++i)
        ways[i].add(best[i], source.name + " to " + target.name);
      ++pairs;
    }
  const auto& [tracks, random] = ways;
  Figure figure = mean(tracks, pairs);
  figure.reference = Reference{random.name, random.sum_per_s / pairs};
  figure.ratio_budget = 0.7;
  print(figure);
  print({.name = "tracks, poses done",
         .value = tracks.sum_poses_per_s / pairs,
         .unit = "poses/s",
         .better = Better::Higher,
         .reference = Reference{random.name, random.sum_poses_per_s / pairs}});
  print(slowest(tracks));
  print(mean(random, pairs));
  print(slowest(random));
}

}  // namespace
}  // namespace kinship::bench

int main() { kinship::bench::measure(kinship::bench::teachers()); }
