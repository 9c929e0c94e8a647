// Durable reports per second against appending as many bytes with fdatasync, in one run.
// Usage: store_bench [DIRECTORY [SECONDS]]   DIRECTORY: on the disk to be measured; default: here.

#include <fcntl.h>
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

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::store {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kWaypoints = 146;  // 8176 bytes as float64
constexpr std::size_t kBytes = 8192;

struct Rate {
  double per_s = 0;
  double p50_ms = 0, p99_ms = 0;
};

Rate rate_of(std::vector<double> latencies_ms, double seconds) {
  std::ranges::sort(latencies_ms);
  const auto at = [&](double share) {
    return latencies_ms[static_cast<std::size_t>(share *
                                                 static_cast<double>(latencies_ms.size() - 1))];
  };
  return {static_cast<double>(latencies_ms.size()) / seconds, at(0.5), at(0.99)};
}

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Rate raw_appends(const std::filesystem::path& file, double seconds) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const std::vector<char> block(kBytes, 'x');
  std::vector<double> latencies_ms;
  const Clock::time_point begin = Clock::now();
  while (ms_since(begin) < 1e3 * seconds) {
    const Clock::time_point start = Clock::now();
    if (write(descriptor, block.data(), block.size()) < 0 || fdatasync(descriptor) != 0) {
      std::cerr << "store_bench: cannot write " << file << "\n";
      std::exit(1);
    }
    latencies_ms.push_back(ms_since(start));
  }
  close(descriptor);
  return rate_of(std::move(latencies_ms), seconds);
}

/// A random walk: what a planner's path looks like to a compressor.
Attempt make_report(const Digest& robot, std::mt19937_64& generator) {
  std::normal_distribution<double> step(0, 0.05);
  Eigen::MatrixXd waypoints(kDof, kWaypoints);
  waypoints.col(0).setZero();
  for (Eigen::Index i = 1; i < kWaypoints; ++i)
    for (Eigen::Index joint = 0; joint < kDof; ++joint)
      waypoints(joint, i) = waypoints(joint, i - 1) + step(generator);
  Attempt attempt = test::make_attempt(robot, "bench", generator());
  attempt.path = Path(std::move(waypoints));
  return attempt;
}

Rate reports(Store& store, const Digest& robot, std::uint64_t clients, double seconds) {
  std::vector<std::vector<double>> latencies_ms(clients);
  std::vector<std::thread> threads;
  static std::uint64_t seed = 1;
  const Clock::time_point begin = Clock::now();
  for (std::uint64_t client = 0; client < clients; ++client)
    threads.emplace_back([&, client, own_seed = seed++] {
      std::mt19937_64 generator(own_seed);
      while (ms_since(begin) < 1e3 * seconds) {
        Attempt attempt = make_report(robot, generator);
        const Clock::time_point start = Clock::now();
        if (test::report(store, {std::move(attempt)})[0].status != ReceiptStatus::Stored)
          std::exit(1);
        latencies_ms[client].push_back(ms_since(start));
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  std::vector<double> all;
  for (const std::vector<double>& one : latencies_ms)
    all.insert(all.end(), one.begin(), one.end());
  return rate_of(std::move(all), seconds);
}

void print(const std::string& what, const Rate& rate, double raw_per_s) {
  std::cout << std::left << std::setw(32) << what << std::right << std::fixed
            << std::setprecision(0) << std::setw(8) << rate.per_s << "/s" << std::setprecision(2)
            << std::setw(9) << rate.p50_ms << std::setw(9) << rate.p99_ms << std::setw(9)
            << rate.per_s / raw_per_s << "\n";
}

int run(const std::filesystem::path& directory, double seconds) {
  const std::filesystem::path file = directory / ("store_bench-" + std::to_string(getpid()));
  const RobotRecord robot = [] {
    RobotRecord record = test::make_robot("bench", 1);
    record.dof = kDof;
    return record;
  }();
  const Rate raw_before = raw_appends(file.string() + ".raw", seconds);
  Rate one;
  Rate sixteen;
  StoreStatus status;
  {
    const std::unique_ptr<Store> store = open_sqlite_store(file);
    if (!store->register_robot(robot))
      return 1;
    one = reports(*store, robot.digest, 1, seconds);
    sixteen = reports(*store, robot.digest, 16, seconds);
    status = store->status();
  }
  const Rate raw_after = raw_appends(file.string() + ".raw", seconds);
  const double raw_per_s = (raw_before.per_s + raw_after.per_s) / 2;
  std::cout << "                                     rate    p50 ms   p99 ms   against raw\n";
  print("append 8 KB + fdatasync, before", raw_before, raw_per_s);
  print("append 8 KB + fdatasync, after", raw_after, raw_per_s);
  print("durable report, 1 client", one, raw_per_s);
  print("durable report, 16 clients", sixteen, raw_per_s);
  std::cout << "16 clients against one: " << sixteen.per_s / one.per_s << "; "
            << status.bytes / status.paths << " bytes of file per path\n";
  for (const char* const suffix : {"", ".raw", ".lock"})
    std::filesystem::remove(file.string() + suffix);
  return 0;
}

}  // namespace
}  // namespace kinship::store

int main(int count, char** arguments) {
  return kinship::store::run(count > 1 ? arguments[1] : ".",
                             count > 2 ? std::atof(arguments[2]) : 3);
}
