// What a store costs besides reports: a backup alone and beside a client that reports, a check, an
// export, the sums of the attempts.
// Usage: store_maintenance_bench [DIRECTORY [PATHS [ATTEMPTS]]]
// DIRECTORY: on the disk to be measured; default: here. PATHS of 8 KB: default 20000. ATTEMPTS
// without a path: default 1000000.

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::store {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kWaypoints = 146;  // 8176 bytes as float64
constexpr int kRounds = 5;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() / 2];
}

void print(const std::string& what, double value, const std::string& unit) {
  std::cout << std::left << std::setw(52) << what << std::right << std::setw(12)
            << std::setprecision(4) << value << ' ' << unit << std::endl;
}

Attempt make_report(const Digest& robot, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> offset(-1, 1);
  Eigen::MatrixXd waypoints(kDof, kWaypoints);
  double value = offset(generator);
  for (Eigen::Index i = 0; i < waypoints.size(); ++i)
    waypoints(i % kDof, i / kDof) = value += 0.01 * offset(generator);
  Attempt attempt = test::make_attempt(robot, "bench", generator());
  attempt.path = Path(std::move(waypoints));
  return attempt;
}

/// A client that reports one path after the other until it is stopped.
class Client {
 public:
  Client(Store& store, const Digest& robot, std::uint64_t seed)
      : thread_([this, &store, robot, seed] {
          std::mt19937_64 generator(seed);
          while (!stop_) {
            Attempt attempt = make_report(robot, generator);
            const Clock::time_point start = Clock::now();
            test::report(store, {std::move(attempt)});
            latencies_ms_.push_back(1e3 * seconds_since(start));
          }
        }) {}
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client() { thread_.join(); }

  std::vector<double> stop() {
    stop_ = true;
    thread_.join();
    thread_ = std::thread([] {});
    return latencies_ms_;
  }

 private:
  std::atomic<bool> stop_ = false;
  std::vector<double> latencies_ms_;
  std::thread thread_;  // last: uses all above
};

void print_latencies(const std::string& who, std::vector<double> latencies_ms, double seconds) {
  if (latencies_ms.empty())
    return;
  std::ranges::sort(latencies_ms);
  const auto last = static_cast<double>(latencies_ms.size() - 1);
  const auto at = [&](double share) {
    return latencies_ms[static_cast<std::size_t>(share * last)];
  };
  print(who + ": reports", static_cast<double>(latencies_ms.size()) / seconds, "/s");
  print(who + ": p50", at(0.5), "ms");
  print(who + ": p99", at(0.99), "ms");
  print(who + ": max", at(1), "ms");
}

class Bench {
 public:
  Bench(std::filesystem::path file, std::uint64_t paths, std::uint64_t attempts)
      : file_(std::move(file)), copy_(file_.string() + ".copy"), store_(open_sqlite_store(file_)) {
    robot_.dof = kDof;
    static_cast<void>(store_->register_robot(robot_).value_or_throw());
    fill(paths, [&] { return make_report(robot_.digest, generator_); });
    fill_attempts(attempts);
  }

  void run() {
    sums();
    exports();
    backups();
    store_.reset();
    checks();
  }

 private:
  template <typename Make>
  void fill(std::uint64_t count, Make make) {
    constexpr std::uint64_t kBatch = 256;
    for (std::uint64_t done = 0; done < count; done += kBatch) {
      std::vector<Attempt> attempts;
      for (std::uint64_t i = 0; i < std::min(kBatch, count - done); ++i)
        attempts.push_back(make());
      test::report(*store_, std::move(attempts));
    }
  }
  void fill_attempts(std::uint64_t count) {
    fill(count, [&] {
      Attempt attempt = test::make_unsolved(robot_.digest, "many", generator_());
      attempt.record.arm = generator_() % 2 == 0 ? Arm::Guided : Arm::Control;
      return attempt;
    });
  }

  void sums() {
    std::vector<double> times_ms;
    double attempts = 0;
    for (int round = 0; round < 100; ++round) {
      const Clock::time_point start = Clock::now();
      const AttemptTotals totals = store_->attempt_totals(robot_.digest, "many");
      times_ms.push_back(1e3 * seconds_since(start));
      attempts = static_cast<double>(totals.guided.attempts + totals.control.attempts);
    }
    print("attempts of a robot and task", attempts, "");
    print("their sums", median(times_ms), "ms");
  }

  void exports() {
    std::vector<double> rates;
    for (int round = 0; round < kRounds; ++round) {
      const Clock::time_point start = Clock::now();
      double attempts = 0;
      std::string cursor;
      do {
        const Page<Attempt> page = store_->export_attempts({}, "bench", cursor, 1000, 400'000);
        attempts += static_cast<double>(page.rows.size());
        cursor = page.next_cursor;
      } while (!cursor.empty());
      rates.push_back(attempts / seconds_since(start));
    }
    print("export of a task", median(rates), "paths/s");
  }

  double backup_once() {
    std::filesystem::remove(copy_);
    const Clock::time_point start = Clock::now();
    std::uintmax_t wal = 0;
    static_cast<void>(store_
                          ->backup(copy_,
                                   [&](double) {
                                     std::error_code ignored;
                                     wal = std::max(wal, std::filesystem::file_size(
                                                             file_.string() + "-wal", ignored));
                                     return true;
                                   })
                          .value_or_throw());
    largest_wal_ = std::max(largest_wal_, wal);
    return seconds_since(start);
  }

  void backups() {
    std::vector<double> alone;
    std::vector<double> beside;
    std::vector<double> quiet_ms;
    std::vector<double> during_ms;
    double quiet_s = 0;
    double during_s = 0;
    for (int round = 0; round < kRounds; ++round) {
      alone.push_back(backup_once());
      const Clock::time_point start = Clock::now();
      {
        Client client(*store_, robot_.digest, generator_());
        std::this_thread::sleep_for(std::chrono::seconds(1));
        const std::vector<double> seen = client.stop();
        quiet_ms.insert(quiet_ms.end(), seen.begin(), seen.end());
      }
      quiet_s += seconds_since(start);
      const Clock::time_point busy = Clock::now();
      {
        Client client(*store_, robot_.digest, generator_());
        beside.push_back(backup_once());
        const std::vector<double> seen = client.stop();
        during_ms.insert(during_ms.end(), seen.begin(), seen.end());
      }
      during_s += seconds_since(busy);
    }
    print("size of the backup", static_cast<double>(std::filesystem::file_size(copy_)) / 1e6, "MB");
    print("backup, nobody reports", median(alone), "s");
    print("backup, a client reports", median(beside), "s");
    print("largest WAL meanwhile", static_cast<double>(largest_wal_) / 1e6, "MB");
    print_latencies("a client, no backup", quiet_ms, quiet_s);
    print_latencies("a client, during a backup", during_ms, during_s);
  }

  void checks() {
    std::vector<double> check_s;
    std::vector<double> restore_s;
    const std::filesystem::path restored = file_.string() + ".restored";
    for (int round = 0; round < kRounds; ++round) {
      Clock::time_point start = Clock::now();
      if (check_store(file_, [](double) {}).problems > 0)
        std::exit(1);
      check_s.push_back(seconds_since(start));
      start = Clock::now();
      restore_store(copy_, restored, [](double) {});
      restore_s.push_back(seconds_since(start));
      std::filesystem::remove(restored);
    }
    print("check", median(check_s), "s");
    print("restore", median(restore_s), "s");
    for (const char* const suffix : {"", ".lock", ".copy", ".restored.lock"})
      std::filesystem::remove(file_.string() + suffix);
  }

  std::filesystem::path file_;
  std::filesystem::path copy_;
  std::unique_ptr<Store> store_;
  RobotRecord robot_ = test::make_robot("bench", 1);
  std::mt19937_64 generator_{1};
  std::uintmax_t largest_wal_ = 0;
};

}  // namespace
}  // namespace kinship::store

int main(int count, char** arguments) {
  const std::filesystem::path directory = count > 1 ? arguments[1] : ".";
  const auto number = [&](int index, std::uint64_t otherwise) {
    return count > index ? std::strtoull(arguments[index], nullptr, 10) : otherwise;
  };
  kinship::store::Bench(directory / ("store_bench-" + std::to_string(getpid())), number(2, 20'000),
                        number(3, 1'000'000))
      .run();
}
