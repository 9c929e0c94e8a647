#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "server/store/store.hpp"
#include "tests/support/store_values.hpp"

/// A store as a fleet fills it: so many paths in so many (robot, task) pairs, equal for equal
/// numbers.
namespace kinship::bench {

/// A file in the current directory, gone with what SQLite lays beside it.
class StoreFile {
 public:
  explicit StoreFile(const std::string& name)
      : path_("store_bench-" + std::to_string(getpid()) + "-" + name) {
    remove();
  }
  StoreFile(const StoreFile&) = delete;
  StoreFile& operator=(const StoreFile&) = delete;
  ~StoreFile() { remove(); }

  const std::filesystem::path& path() const noexcept { return path_; }
  double bytes(const std::string& suffix = "") const {
    std::error_code missing;
    const auto size = std::filesystem::file_size(path_.string() + suffix, missing);
    return missing ? 0 : static_cast<double>(size);
  }
  void remove() const {
    std::error_code ignored;
    for (const char* suffix : {"", "-wal", "-shm", ".lock", ".high-water-mark"})
      std::filesystem::remove(path_.string() + suffix, ignored);
  }

 private:
  std::filesystem::path path_;
};

struct FillPlan {
  std::uint64_t paths = 0;
  std::uint64_t pairs = 0;
  Eigen::Index dof = 7;
  Eigen::Index waypoints = 40;  ///< of a path

  std::uint64_t paths_of_pair() const { return paths / pairs; }
};

/// \param arguments  of a program: PATHS PAIRS. \return nothing, and says how it is used, if they
///                   are too few.
inline std::optional<FillPlan> plan_from(int count, char** arguments) {
  constexpr std::uint64_t kLeastPathsOfPair = 500;
  FillPlan plan;
  if (count >= 3) {
    plan.paths = std::strtoull(arguments[1], nullptr, 10);
    plan.pairs = std::strtoull(arguments[2], nullptr, 10);
  }
  if (plan.pairs >= 2 && plan.paths_of_pair() >= kLeastPathsOfPair)
    return plan;
  std::cerr << "usage: " << arguments[0] << " PATHS PAIRS, at least 2 pairs of "
            << kLeastPathsOfPair << " paths\n";
  return std::nullopt;
}

/// One (robot, task) pair of a fleet. The first is alone with its robot and its task, so that what
/// is listed of it is the same whatever the others have; the others share robots and tasks.
struct Pair {
  Digest robot;
  std::string task;
};

class Fleet {
 public:
  static constexpr std::uint64_t kTasks = 10;        ///< of each robot but the first
  static constexpr const char* kAlone = "zz alone";  ///< the first robot: the last in listings

  explicit Fleet(const FillPlan& plan) : plan_(plan) {
    const std::uint64_t robots = 1 + (plan.pairs - 1 + kTasks - 1) / kTasks;
    for (std::uint64_t i = 0; i < robots; ++i) {
      robots_.push_back(test::make_robot(i == 0 ? kAlone : "robot " + std::to_string(i), i + 1));
      robots_.back().dof = static_cast<std::uint32_t>(plan.dof);
    }
    for (std::uint64_t i = 0; i < plan.pairs; ++i)
      pairs_.push_back(i == 0 ? Pair{robots_[0].digest, "alone"}
                              : Pair{robots_[1 + (i - 1) / kTasks].digest,
                                     "task-" + std::to_string((i - 1) % kTasks)});
  }

  const std::vector<Pair>& pairs() const noexcept { return pairs_; }

  /// \param number  of the path within its pair.
  Attempt attempt(std::uint64_t pair, std::uint64_t number) const {
    const std::uint64_t seed = 1 + pair + plan_.pairs * number;
    Attempt made = test::make_attempt(pairs_[pair].robot, pairs_[pair].task, seed);
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> step(-0.1, 0.1);
    Eigen::MatrixXd waypoints(plan_.dof, plan_.waypoints);
    waypoints.col(0).setConstant(0.5);
    for (Eigen::Index i = 1; i < plan_.waypoints; ++i)
      waypoints.col(i) = waypoints.col(i - 1) +
                         Eigen::VectorXd::NullaryExpr(plan_.dof, [&] { return step(generator); });
    made.path = Path(std::move(waypoints));
    made.record.sampling_mode = number % 2 == 0 ? SamplingMode::Guided : SamplingMode::Control;
    return made;
  }

  void register_robots(store::Store& store) const {
    for (const store::RobotRecord& robot : robots_)
      static_cast<void>(store.register_robot(robot).value_or_throw());
  }

  /// Reports all paths of the first `pairs` pairs, a batch of each in turn, and stores a few
  /// distributions of each.
  /// \param after_batch  called with the number of paths reported so far.
  void fill(store::Store& store, std::uint64_t pairs,
            const std::function<void(std::uint64_t)>& after_batch) const {
    constexpr std::uint64_t kBatch = 250, kDistributions = 10;
    register_robots(store);
    std::uint64_t reported = 0;
    for (std::uint64_t first = 0; first < plan_.paths_of_pair(); first += kBatch)
      for (std::uint64_t pair = 0; pair < pairs; ++pair) {
        std::vector<Attempt> attempts;
        for (std::uint64_t i = first; i < std::min(first + kBatch, plan_.paths_of_pair()); ++i)
          attempts.push_back(attempt(pair, i));
        reported += attempts.size();
        for (const Receipt& receipt : test::report(store, std::move(attempts)))
          if (receipt.status != ReceiptStatus::Stored)
            throw std::runtime_error("a report was not stored: " + receipt.message);
        after_batch(reported);
      }
    for (std::uint64_t pair = 0; pair < pairs; ++pair)
      for (std::uint64_t i = 0; i < kDistributions; ++i)
        store.put_distribution(test::make_distribution(pairs_[pair].robot, pairs_[pair].task,
                                                       distribution_number(pair, i)));
  }

  /// Of test::make_distribution().
  static std::uint64_t distribution_number(std::uint64_t pair, std::uint64_t number) {
    return 1'000'000'000 + 1000 * pair + number;
  }

 private:
  FillPlan plan_;
  std::vector<store::RobotRecord> robots_;
  std::vector<Pair> pairs_;
};

}  // namespace kinship::bench
