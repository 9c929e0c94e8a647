// A store of 1 000 000 paths, in the current directory: how fast it fills, opens and answers for
// one of its tasks, and what a backup takes.
//
//   large_store_bench

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::store {
namespace {

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kWaypoints = 12;  // of a shortened path
constexpr std::uint64_t kPaths = 1'000'000;
constexpr std::uint64_t kPathsOfTask = 500;
constexpr double kMB = 1e6;

/// A file in the current directory, gone with what SQLite lays beside it.
class StoreFile {
 public:
  explicit StoreFile(const std::string& name)
      : path_("large_store_bench-" + std::to_string(getpid()) + "-" + name) {}
  StoreFile(const StoreFile&) = delete;
  StoreFile& operator=(const StoreFile&) = delete;
  ~StoreFile() {
    std::error_code ignored;
    for (const char* suffix : {"", "-wal", "-shm", ".lock", ".witness"})
      std::filesystem::remove(path_.string() + suffix, ignored);
  }
  const std::filesystem::path& path() const noexcept { return path_; }
  double wal_bytes() const {
    std::error_code missing;
    const auto bytes = std::filesystem::file_size(path_.string() + "-wal", missing);
    return missing ? 0 : static_cast<double>(bytes);
  }

 private:
  std::filesystem::path path_;
};

std::unique_ptr<Store> make_store(const StoreFile& file, RobotRecord robot) {
  robot.dof = kDof;
  auto store = open_sqlite_store(file.path());
  static_cast<void>(store->register_robot(robot).value_or_throw());
  return store;
}

/// Reports `count` paths, kPathsOfTask of each task, and looks at the WAL after every batch.
/// \return the largest WAL, bytes.
double fill(Store& store, const StoreFile& file, const Digest& robot, std::uint64_t count) {
  constexpr std::uint64_t kBatch = 250;
  static_assert(kPathsOfTask % kBatch == 0);
  double largest = 0;
  for (std::uint64_t first = 0; first < count; first += kBatch) {
    const std::string task = "task " + std::to_string(first / kPathsOfTask);
    std::vector<Attempt> attempts;
    for (std::uint64_t i = first; i < first + kBatch; ++i) {
      Attempt attempt = test::make_attempt(robot, task, i + 1);
      attempt.path = test::make_path(i + 1, kDof, kWaypoints);
      attempts.push_back(std::move(attempt));
    }
    for (const Receipt& receipt : test::report(store, std::move(attempts)))
      if (receipt.status != ReceiptStatus::Stored)
        throw std::runtime_error("a report was not stored");
    largest = std::max(largest, file.wal_bytes());
    if (first % 100'000 == 0)
      std::cerr << first << " of " << count << " paths\n";
  }
  return largest;
}

/// What a cold fetch reads of one task, ms.
double read_task_ms(const Store& store, const Digest& robot) {
  const double taken_s = bench::least_s(20, bench::wall_s, [&] {
    static_cast<void>(store.experience("task 0"));
    if (store.read_paths(robot, "task 0", {.limit = kPathsOfTask}).size() != kPathsOfTask)
      throw std::runtime_error("paths are missing");
  });
  return 1e3 * taken_s;
}

void run() {
  const RobotRecord robot = test::make_robot("bench", 1);
  const StoreFile small_file("small"), file("large"), copy("copy");
  const auto small = make_store(small_file, robot);
  fill(*small, small_file, robot.digest, kPathsOfTask);
  auto store = make_store(file, robot);
  const double start_s = bench::wall_s();
  const double largest_wal = fill(*store, file, robot.digest, kPaths);
  bench::print({.name = "paths stored, batches of 250",
                .value = static_cast<double>(kPaths) / (bench::wall_s() - start_s),
                .unit = "paths/s",
                .better = bench::Better::Higher});
  bench::print(
      {.name = "largest WAL meanwhile", .value = largest_wal / kMB, .unit = "MB", .budget = 64});
  std::vector<double> open_ms;
  for (int i = 0; i < 5; ++i) {
    store.reset();
    const double open_s = bench::wall_s();
    store = open_sqlite_store(file.path());
    open_ms.push_back(1e3 * (bench::wall_s() - open_s));
  }
  bench::print({.name = "open", .value = bench::median(open_ms), .unit = "ms", .budget = 50});
  bench::print({.name = "experience of one task read, 500 paths",
                .value = read_task_ms(*store, robot.digest),
                .unit = "ms",
                .reference = bench::Reference{"no other task", read_task_ms(*small, robot.digest)},
                .ratio_budget = 1.5});
  const double backup_s = bench::wall_s();
  static_cast<void>(store->backup(copy.path(), [](double) { return true; }).value_or_throw());
  bench::print(
      {.name = "backup",
       .value = bench::wall_s() - backup_s,
       .unit = "s",
       .note = std::to_string(std::filesystem::file_size(copy.path()) / 1'000'000) + " MB"});
}

}  // namespace
}  // namespace kinship::store

int main() { kinship::store::run(); }
