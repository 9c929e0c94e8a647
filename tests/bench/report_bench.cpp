// Durable reports per second against appending as many bytes with fdatasync, in one run.
// Usage: store_bench [DIRECTORY [SECONDS]]   DIRECTORY: on the disk to be measured; default: here.
// SECONDS: for each of the three ways; default 6.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
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

/// What was seen in all rounds of one way to write.
struct Seen {
  std::vector<double> latencies_ms;
  double seconds = 0;

  Rate rate() const {
    std::vector<double> sorted = latencies_ms;
    std::ranges::sort(sorted);
    const auto last = static_cast<double>(sorted.size() - 1);
    const auto at = [&](double share) { return sorted[static_cast<std::size_t>(share * last)]; };
    return {static_cast<double>(sorted.size()) / seconds, at(0.5), at(0.99)};
  }
};

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void raw_appends(const std::filesystem::path& file, double seconds, Seen& seen) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const std::vector<char> block(kBytes, 'x');
  const Clock::time_point begin = Clock::now();
  while (ms_since(begin) < 1e3 * seconds) {
    const Clock::time_point start = Clock::now();
    if (write(descriptor, block.data(), block.size()) < 0 || fdatasync(descriptor) != 0) {
      std::cerr << "store_bench: cannot write " << file << "\n";
      std::exit(1);
    }
    seen.latencies_ms.push_back(ms_since(start));
  }
  close(descriptor);
  seen.seconds += ms_since(begin) / 1e3;
}

/// A random walk: the worst that a planner's path can be to a compressor.
Eigen::MatrixXd random_walk() {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> step(0, 0.05);
  Eigen::MatrixXd waypoints = Eigen::MatrixXd::Zero(kDof, kWaypoints);
  for (Eigen::Index i = 1; i < kWaypoints; ++i)
    for (Eigen::Index joint = 0; joint < kDof; ++joint)
      waypoints(joint, i) = waypoints(joint, i - 1) + step(generator);
  return waypoints;
}

/// Cheap to make, because the client's own work is not what is measured.
Attempt make_report(const Digest& robot, std::mt19937_64& generator) {
  static const Eigen::MatrixXd kWalk = random_walk();
  std::uniform_real_distribution<double> offset(-1, 1);
  Eigen::MatrixXd waypoints = (kWalk.array() + offset(generator)).matrix();
  Attempt attempt = test::make_attempt(robot, "bench", generator());
  attempt.path = Path(std::move(waypoints));
  return attempt;
}

class Clients {
 public:
  Clients(Store& store, const Digest& robot) : store_(&store), robot_(robot) {}

  void run(std::size_t count, double seconds, Seen& seen) {
    std::vector<std::vector<double>> latencies_ms(count);
    std::vector<std::thread> threads;
    const Clock::time_point begin = Clock::now();
    for (std::size_t client = 0; client < count; ++client)
      threads.emplace_back([&, client, seed = next_seed_++] {
        std::mt19937_64 generator(seed);
        while (ms_since(begin) < 1e3 * seconds)
          latencies_ms[client].push_back(report_once(generator));
      });
    for (std::thread& thread : threads)
      thread.join();
    seen.seconds += ms_since(begin) / 1e3;
    for (const std::vector<double>& one : latencies_ms)
      seen.latencies_ms.insert(seen.latencies_ms.end(), one.begin(), one.end());
  }

 private:
  double report_once(std::mt19937_64& generator) const {
    Attempt attempt = make_report(robot_, generator);
    const Clock::time_point start = Clock::now();
    if (test::report(*store_, {std::move(attempt)})[0].status != ReceiptStatus::Stored)
      std::exit(1);
    return ms_since(start);
  }

  Store* store_;
  Digest robot_;
  std::uint64_t next_seed_ = 1;
};

void print(const std::string& what, const Rate& rate, double raw_per_s) {
  std::cout << std::left << std::setw(28) << what << std::right << std::fixed
            << std::setprecision(0) << std::setw(8) << rate.per_s << "/s" << std::setprecision(2)
            << std::setw(10) << rate.p50_ms << std::setw(10) << rate.p99_ms << std::setw(10)
            << rate.per_s / raw_per_s << "\n";
}

int run(const std::filesystem::path& directory, double seconds) {
  const std::filesystem::path file = directory / ("store_bench-" + std::to_string(getpid()));
  RobotRecord robot = test::make_robot("bench", 1);
  robot.dof = kDof;
  Seen raw;
  Seen one;
  Seen sixteen;
  {
    const std::unique_ptr<Store> store = open_sqlite_store(file);
    if (!store->register_robot(robot))
      return 1;
    Clients clients(*store, robot.digest);
    constexpr int kRounds = 5;  // taken in turn, because the disk's own rate comes and goes
    for (int round = 0; round < kRounds; ++round) {
      raw_appends(file.string() + ".raw", seconds / kRounds, raw);
      clients.run(1, seconds / kRounds, one);
      clients.run(16, seconds / kRounds, sixteen);
    }
  }
  const double raw_per_s = raw.rate().per_s;
  std::cout << "                                rate    p50 ms    p99 ms   to raw\n";
  print("append 8 KB + fdatasync", raw.rate(), raw_per_s);
  print("durable report, 1 client", one.rate(), raw_per_s);
  print("durable report, 16 clients", sixteen.rate(), raw_per_s);
  std::cout << "16 clients to one: " << sixteen.rate().per_s / one.rate().per_s << "\n";
  for (const char* const suffix : {"", ".raw", ".lock"})
    std::filesystem::remove(file.string() + suffix);
  return 0;
}

}  // namespace
}  // namespace kinship::store

int main(int count, char** arguments) {
  return kinship::store::run(count > 1 ? arguments[1] : ".",
                             count > 2 ? std::atof(arguments[2]) : 6);
}
