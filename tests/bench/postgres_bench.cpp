// Durable reports of 8 KB a second into PostgreSQL by 1, 2 and 4 stores over one database, against
// pgbench's inserts of as many bytes into the same cluster, in turn; what a synchronous standby
// adds to a receipt. All on one disk and its processors: a store, the primary, the standby and the
// clients share them.
//
//   postgres_bench

#include <chrono>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/pgbench.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::store {
namespace {

constexpr Eigen::Index kDof = 7;
constexpr Eigen::Index kWaypoints = 146;  // 8176 bytes as float64
constexpr int kTasks = 4;
constexpr int kRounds = 3;  // in turn, because the disk's own rate comes and goes
constexpr double kRound_s = 1.5;

/// What was seen in all rounds of one way to write.
struct Seen {
  std::vector<double> latencies_ms;
  double seconds = 0;

  double per_s() const { return static_cast<double>(latencies_ms.size()) / seconds; }
};

const RobotRecord& robot() {
  static const RobotRecord kRobot = [] {
    RobotRecord made = test::make_robot("bench", 1);
    made.dof = kDof;
    return made;
  }();
  return kRobot;
}

/// A random walk, moved: the worst that a planner's path can be to a compressor, and cheap to make.
Attempt make_report(int task, std::mt19937_64& generator) {
  static const Eigen::MatrixXd kWalk = [] {
    std::mt19937_64 steps(1);
    std::normal_distribution<double> step(0, 0.05);
    Eigen::MatrixXd waypoints = Eigen::MatrixXd::Zero(kDof, kWaypoints);
    for (Eigen::Index i = 1; i < kWaypoints; ++i)
      for (Eigen::Index joint = 0; joint < kDof; ++joint)
        waypoints(joint, i) = waypoints(joint, i - 1) + step(steps);
    return waypoints;
  }();
  std::uniform_real_distribution<double> offset(-1, 1);
  Attempt attempt =
      test::make_attempt(robot().digest, "bench_" + std::to_string(task), generator());
  attempt.path = Path(Eigen::MatrixXd((kWalk.array() + offset(generator)).matrix()));
  return attempt;
}

/// Clients of some stores over one database, each with one report on its way.
class PostgresClients {
 public:
  explicit PostgresClients(const std::string& url, std::size_t stores) {
    for (std::size_t i = 0; i < stores; ++i)
      stores_.push_back(open_postgres_store(url));
    static_cast<void>(stores_.front()->register_robot(robot()));
  }

  void run(std::size_t clients, Seen& seen) {
    std::vector<std::vector<double>> latencies_ms(clients);
    std::vector<std::thread> threads;
    const double begin_s = bench::wall_s();
    for (std::size_t client = 0; client < clients; ++client)
      threads.emplace_back([&, client] {
        std::mt19937_64 generator(std::random_device{}());
        Store& store = *stores_[client % stores_.size()];
        while (bench::wall_s() < begin_s + kRound_s)
          latencies_ms[client].push_back(report_once(store, static_cast<int>(client), generator));
      });
    for (std::thread& thread : threads)
      thread.join();
    seen.seconds += bench::wall_s() - begin_s;
    for (const std::vector<double>& one : latencies_ms)
      seen.latencies_ms.insert(seen.latencies_ms.end(), one.begin(), one.end());
  }

 private:
  static double report_once(Store& store, int client, std::mt19937_64& generator) {
    Attempt attempt = make_report(client % kTasks, generator);
    const double start_s = bench::wall_s();
    const Receipt receipt = test::report(store, {std::move(attempt)}).at(0);
    if (receipt.status != ReceiptStatus::Stored) {
      std::cerr << "postgres_bench: not stored: " << receipt.message << '\n';
      std::exit(1);
    }
    return 1e3 * (bench::wall_s() - start_s);
  }

  std::vector<std::unique_ptr<Store>> stores_;
};

std::string latencies(const Seen& seen) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "p50 " << bench::median(seen.latencies_ms)
       << " ms, p99 " << bench::percentile(seen.latencies_ms, 0.99) << " ms";
  return text.str();
}

test::PostgresCluster::Options durable(const std::string& name, const std::string& standbys) {
  return {.name = name,
          .settings = {"fsync = on", "synchronous_standby_names = '" + standbys + "'"},
          .root = test::disk_root()};
}

void measure_rates() {
  const test::PostgresCluster cluster(durable("a", ""));
  const std::string url = cluster.create_database("bench");
  bench::prepare_pgbench(cluster, "bench");
  std::vector<double> inserts_per_s;
  std::map<std::size_t, Seen> seen;  // by the number of stores
  Seen before;
  PostgresClients(url, 1).run(16, before);
  cluster.query("ANALYZE", "bench");  // as autovacuum does within a minute
  for (int round = 0; round < kRounds; ++round) {
    inserts_per_s.push_back(bench::pgbench_inserts_per_s(cluster, "bench", 16, kRound_s));
    for (const std::size_t stores : {1U, 2U, 4U})
      PostgresClients(url, stores).run(16, seen[stores]);
  }
  for (const auto& [stores, of_stores] : seen)
    bench::print({.name = "durable reports, 16 clients of " + std::to_string(stores) +
                          (stores == 1 ? " store" : " stores"),
                  .value = of_stores.per_s(),
                  .unit = "reports/s",
                  .better = bench::Better::Higher,
                  .reference = bench::Reference{"pgbench's inserts of 8 KB, 16 clients",
                                                bench::median(inserts_per_s)},
                  .note = latencies(of_stores)});
}

void measure_receipts(bool has_standby) {
  const test::PostgresCluster primary(durable("a", has_standby ? "ANY 1 (b)" : ""));
  const std::string url = primary.create_database("bench");
  std::unique_ptr<test::PostgresCluster> standby;
  if (has_standby)
    standby = std::make_unique<test::PostgresCluster>(primary, durable("b", ""));
  PostgresClients clients(url, 1);
  Seen before, seen;
  clients.run(1, before);
  primary.query("ANALYZE", "bench");
  for (int round = 0; round < kRounds; ++round)
    clients.run(1, seen);
  const std::string beside = has_standby ? ", synchronous standby" : ", no standby";
  for (const auto& [name, share] : {std::pair("p50", 0.5), std::pair("p99", 0.99)})
    bench::print({.name = "receipt of 1 client, " + std::string(name) + beside,
                  .value = bench::percentile(seen.latencies_ms, share),
                  .unit = "ms"});
}

int run() {
  if (const std::string missing = test::missing_postgres(); !missing.empty()) {
    std::cerr << "postgres_bench: " << missing << '\n';
    return 1;
  }
  measure_rates();
  measure_receipts(false);
  measure_receipts(true);
  return 0;
}

}  // namespace
}  // namespace kinship::store

int main() { return kinship::store::run(); }
