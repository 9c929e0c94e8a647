// Durable reports of 8 KB per second against appending as many bytes with fdatasync, in turn, in
// the current directory, which is on the disk to be measured.
//
//   report_bench

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::store {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kWaypoints = 146;  // 8176 bytes as float64
constexpr std::size_t kBytes = 8192;

/// What was seen in all rounds of one way to write.
struct Seen {
  std::vector<double> latencies_ms;
  double seconds = 0;

  double per_s() const { return static_cast<double>(latencies_ms.size()) / seconds; }
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
      std::cerr << "report_bench: cannot write " << file << "\n";
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

std::string latencies(const Seen& seen) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "p50 " << bench::median(seen.latencies_ms)
       << " ms, p99 " << bench::percentile(seen.latencies_ms, 0.99) << " ms";
  return text.str();
}

void print(const std::string& name, const Seen& seen, const bench::Reference& reference,
           double ratio_budget) {
  bench::print({.name = name,
                .value = seen.per_s(),
                .unit = "reports/s",
                .better = bench::Better::Higher,
                .reference = reference,
                .ratio_budget = ratio_budget,
                .note = latencies(seen)});
}

int run() {
  const std::filesystem::path file = "report_bench-" + std::to_string(getpid());
  RobotRecord robot = test::make_robot("bench", 1);
  robot.dof = kDof;
  Seen raw, one, sixteen;
  {
    const std::unique_ptr<Store> store = open_sqlite_store(file);
    if (!store->register_robot(robot))
      return 1;
    Clients clients(*store, robot.digest);
    constexpr int kRounds = 5;  // taken in turn, because the disk's own rate comes and goes
    constexpr double kRound_s = 0.8;
    for (int round = 0; round < kRounds; ++round) {
      raw_appends(file.string() + ".raw", kRound_s, raw);
      clients.run(1, kRound_s, one);
      clients.run(16, kRound_s, sixteen);
    }
  }
  print("durable reports, 1 client", one, {"append 8 KB + fdatasync", raw.per_s()}, 0.8);
  print("durable reports, 16 clients", sixteen, {"1 client", one.per_s()}, 2.5);
  for (const char* const suffix : {"", ".raw", ".lock", ".witness"})
    std::filesystem::remove(file.string() + suffix);
  return 0;
}

}  // namespace
}  // namespace kinship::store

int main() { return kinship::store::run(); }
