// A store of many paths in many (robot, task) pairs, in the current directory: how it fills and
// opens, what reading and listing one pair costs beside a store that has that pair alone, reports
// to a pair that has as many paths as it may, and backups beside a writer.
//
//   large_store_bench PATHS PAIRS      1000000 200: 4 GB, a quarter of an hour

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/filled_store.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/store_questions.hpp"

namespace kinship::bench {
namespace {

constexpr double kMB = 1e6;

/// Beyond the paths that any pair was filled with.
constexpr std::uint64_t kFirstLater = 1'000'000'000;

/// As a server opens it before it serves, ms.
double open_ms(const StoreFile& file, std::unique_ptr<store::Store>& store) {
  store.reset();
  const double start_s = wall_s();
  store = store::open_sqlite_store(file.path());
  static_cast<void>(store->robots());
  static_cast<void>(store->status());
  return 1e3 * (wall_s() - start_s);
}

/// The file is on the disk and nowhere in memory.
void drop_from_memory(const StoreFile& file) {
  const int descriptor = open(file.path().c_str(), O_RDONLY | O_CLOEXEC);
  fsync(descriptor);
  posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  close(descriptor);
}

/// A store with its file.
struct OpenStore {
  const StoreFile& file;
  std::unique_ptr<store::Store>& store;
};

void measure_opening(const OpenStore& large, const OpenStore& alone) {
  constexpr int kRounds = 7;
  std::vector<double> warm, cold, warm_alone;
  for (int i = 0; i < kRounds; ++i) {
    warm.push_back(open_ms(large.file, large.store));
    warm_alone.push_back(open_ms(alone.file, alone.store));
  }
  for (int i = 0; i < kRounds; ++i) {
    large.store.reset();
    drop_from_memory(large.file);
    cold.push_back(open_ms(large.file, large.store));
  }
  print({.name = "open",
         .value = median(warm),
         .unit = "ms",
         .reference = Reference{"the pair alone", median(warm_alone)},
         .ratio_budget = 2});
  print({.name = "open, nothing of it in memory", .value = median(cold), .unit = "ms"});
}

std::string latencies(const std::vector<double>& ms) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "p50 " << median(ms) << " ms, p99 "
       << percentile(ms, 0.99) << " ms, max " << percentile(ms, 1) << " ms";
  return text.str();
}

/// A client that reports batches without a pause, on a thread of its own.
class BusyClient {
 public:
  static constexpr std::uint64_t kBatch = 16;

  BusyClient(store::Store& store, const Fleet& fleet, std::uint64_t first)
      : store_(&store), fleet_(&fleet), next_(first), thread_([this] { run(); }) {}
  ~BusyClient() {
    if (thread_.joinable())
      stop();
  }
  BusyClient(const BusyClient&) = delete;
  BusyClient& operator=(const BusyClient&) = delete;

  /// \return what each batch waited for its receipts, ms.
  const std::vector<double>& stop() {
    stopping_ = true;
    thread_.join();
    return waits_ms_;
  }
  double reports_per_s() const { return static_cast<double>(kBatch * waits_ms_.size()) / seconds_; }
  std::uint64_t next() const { return next_; }

 private:
  void run() {
    const double begin_s = wall_s();
    const std::uint64_t pairs = fleet_->pairs().size();
    while (!stopping_) {
      std::vector<Attempt> attempts;
      for (std::uint64_t i = 0; i < kBatch; ++i, ++next_)
        attempts.push_back(fleet_->attempt(next_ % pairs, kFirstLater + next_));
      const double start_s = wall_s();
      static_cast<void>(test::report(*store_, std::move(attempts)));
      waits_ms_.push_back(1e3 * (wall_s() - start_s));
    }
    seconds_ = wall_s() - begin_s;
  }

  store::Store* store_;
  const Fleet* fleet_;
  std::uint64_t next_;
  std::atomic<bool> stopping_ = false;
  std::vector<double> waits_ms_;
  double seconds_ = 0;
  std::thread thread_;  // last: it uses all of the above
};

/// As many bytes copied by hand, MB/s: what the disk gives in this minute.
double copy_rate(const StoreFile& from, const StoreFile& to) {
  const double start_s = wall_s();
  std::filesystem::copy_file(from.path(), to.path());
  const int descriptor = open(to.path().c_str(), O_RDONLY | O_CLOEXEC);
  fsync(descriptor);
  close(descriptor);
  return to.bytes() / kMB / (wall_s() - start_s);
}

double backup_rate(const store::Store& store, const StoreFile& to) {
  const double start_s = wall_s();
  static_cast<void>(store.backup(to.path(), [](double) { return true; }).value_or_throw());
  return to.bytes() / kMB / (wall_s() - start_s);
}

void measure_backups(store::Store& store, const StoreFile& file, const Fleet& fleet) {
  const StoreFile copy("copy"), plain("plain"), idle("idle");
  BusyClient before(store, fleet, 0);
  std::this_thread::sleep_for(std::chrono::seconds(5));  // how long is measured
  const std::vector<double> alone_ms = before.stop();
  BusyClient beside(store, fleet, before.next());
  const double rate = backup_rate(store, copy);
  const std::vector<double> beside_ms = beside.stop();
  const double disk = copy_rate(file, plain);
  print({.name = "backup beside a client that reports without a pause",
         .value = rate,
         .unit = "MB/s",
         .better = Better::Higher,
         .reference = Reference{"the file copied and synced", disk},
         .ratio_budget = 0.04,
         .note = std::to_string(static_cast<int>(copy.bytes() / kMB)) + " MB"});
  print({.name = "its reports meanwhile, batches of 16",
         .value = beside.reports_per_s(),
         .unit = "reports/s",
         .better = Better::Higher,
         .reference = Reference{"without a backup", before.reports_per_s()},
         .note = latencies(beside_ms) + "; without: " + latencies(alone_ms)});
  print({.name = "what a batch waits meanwhile, p99",
         .value = percentile(beside_ms, 0.99),
         .unit = "ms",
         .reference = Reference{"without a backup", percentile(alone_ms, 0.99)}});
  print({.name = "backup while nobody reports",
         .value = backup_rate(store, idle),
         .unit = "MB/s",
         .better = Better::Higher});
}

/// Reports to one pair, a second, with and without a cap that it has reached.
void measure_cap(const StoreFile& file, std::unique_ptr<store::Store>& alone, const Fleet& fleet,
                 const FillPlan& plan) {
  constexpr std::uint64_t kReports = 4000;
  const auto rate = [&](std::uint64_t cap, std::uint64_t first) {
    alone.reset();
    alone = store::open_sqlite_store(file.path(), {.max_paths_per_pair = cap});
    std::vector<Attempt> attempts;
    for (std::uint64_t i = 0; i < kReports; ++i)
      attempts.push_back(fleet.attempt(0, kFirstLater + first + i));
    const double start_s = wall_s();
    for (std::uint64_t i = 0; i < kReports; i += BusyClient::kBatch) {
      const auto begin = attempts.begin() + static_cast<std::ptrdiff_t>(i);
      static_cast<void>(test::report(
          *alone,
          std::vector<Attempt>(begin, begin + static_cast<std::ptrdiff_t>(BusyClient::kBatch))));
    }
    return static_cast<double>(kReports) / (wall_s() - start_s);
  };
  const double capped = rate(plan.paths_of_pair(), 0);
  const std::uint64_t dropped = alone->status().dropped_paths;
  const double without = rate(0, kReports);
  print({.name = "reports to a pair that has as many paths as it may, batches of 16",
         .value = capped,
         .unit = "reports/s",
         .better = Better::Higher,
         .reference = Reference{"without a cap", without},
         .note = std::to_string(dropped) + " of " + std::to_string(kReports) + " paths dropped"});
}

void run(const FillPlan& plan) {
  const Fleet fleet(plan);
  const StoreFile alone_file("alone"), file("large");
  auto alone = store::open_sqlite_store(alone_file.path());
  fleet.fill(*alone, 1, [](std::uint64_t) {});
  auto store = store::open_sqlite_store(file.path());
  double largest_wal = 0, most_in_use = 0;
  const double start_s = wall_s();
  fleet.fill(*store, plan.pairs, [&](std::uint64_t reported) {
    largest_wal = std::max(largest_wal, file.bytes("-wal"));
    if (reported % 50'000 == 0)
      std::cerr << reported << " of " << plan.paths << " paths, " << file.bytes() / kMB << " MB, "
                << wall_s() - start_s << " s\n";
  });
  print({.name = "paths stored, batches of 250",
         .value = static_cast<double>(plan.paths) / (wall_s() - start_s),
         .unit = "paths/s",
         .better = Better::Higher,
         .note = std::to_string(static_cast<int>(file.bytes() / kMB)) + " MB in all"});
  most_in_use = file.bytes("-wal");
  print({.name = "largest WAL meanwhile", .value = largest_wal / kMB, .unit = "MB", .budget = 64});
  print({.name = "WAL afterwards", .value = most_in_use / kMB, .unit = "MB", .budget = 64});
  measure_opening({file, store}, {alone_file, alone});
  measure_questions(questions(fleet, plan), *store, *alone);
  measure_cap(alone_file, alone, fleet, plan);
  measure_backups(*store, file, fleet);
}

}  // namespace
}  // namespace kinship::bench

int main(int count, char** arguments) {
  const auto plan = kinship::bench::plan_from(count, arguments);
  if (!plan)
    return 2;
  kinship::bench::run(*plan);
}
