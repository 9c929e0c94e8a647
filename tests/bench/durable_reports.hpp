#pragma once

#include <cstdlib>
#include <functional>
#include <iomanip>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/bench/measure.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::bench {

/// What was seen in all rounds of one way to write.
struct Seen {
  std::vector<double> latencies_ms;
  double seconds = 0;

  double per_s() const { return static_cast<double>(latencies_ms.size()) / seconds; }

  std::string latencies() const {
    std::ostringstream text;
    text << std::fixed << std::setprecision(2) << "p50 " << median(latencies_ms) << " ms, p99 "
         << percentile(latencies_ms, 0.99) << " ms";
    return text.str();
  }
};

inline const store::RobotRecord& reporting_robot() {
  static const store::RobotRecord kRobot = [] {
    store::RobotRecord made = test::make_robot("bench", 1);
    made.dof = 7;
    return made;
  }();
  return kRobot;
}

/// A random walk of 8176 bytes as float64, moved: the worst that a planner's path can be to a
/// compressor, and cheap to make, because the client's own work is not what is measured.
inline Attempt make_report(const std::string& task, std::mt19937_64& generator) {
  static const Eigen::MatrixXd kWalk = [] {
    std::mt19937_64 steps(1);
    std::normal_distribution<double> step(0, 0.05);
    Eigen::MatrixXd waypoints = Eigen::MatrixXd::Zero(7, 146);
    for (Eigen::Index i = 1; i < waypoints.cols(); ++i)
      for (Eigen::Index joint = 0; joint < waypoints.rows(); ++joint)
        waypoints(joint, i) = waypoints(joint, i - 1) + step(steps);
    return waypoints;
  }();
  std::uniform_real_distribution<double> offset(-1, 1);
  Attempt attempt = test::make_attempt(reporting_robot().digest, task, generator());
  attempt.path = Path(Eigen::MatrixXd((kWalk.array() + offset(generator)).matrix()));
  return attempt;
}

/// \return milliseconds to the receipt.
inline double report_once(store::Store& store, const std::string& task,
                          std::mt19937_64& generator) {
  Attempt attempt = make_report(task, generator);
  const double start_s = wall_s();
  const Receipt receipt = test::report(store, {std::move(attempt)}).at(0);
  if (receipt.status != ReceiptStatus::Stored) {
    std::cerr << "not stored: " << receipt.message << '\n';
    std::exit(1);
  }
  return 1e3 * (wall_s() - start_s);
}

/// Clients at once, each with one report on its way.
/// \param report_ms  one report of a client; the milliseconds it took.
inline void run_reporters(
    std::size_t count, double seconds, Seen& seen,
    const std::function<double(std::size_t client, std::mt19937_64&)>& report_ms) {
  std::vector<std::vector<double>> latencies_ms(count);
  std::vector<std::thread> threads;
  const double begin_s = wall_s();
  for (std::size_t client = 0; client < count; ++client)
    threads.emplace_back([&, client] {
      std::mt19937_64 generator(std::random_device{}());
      while (wall_s() < begin_s + seconds)
        latencies_ms[client].push_back(report_ms(client, generator));
    });
  for (std::thread& thread : threads)
    thread.join();
  seen.seconds += wall_s() - begin_s;
  for (const std::vector<double>& one : latencies_ms)
    seen.latencies_ms.insert(seen.latencies_ms.end(), one.begin(), one.end());
}

}  // namespace kinship::bench
