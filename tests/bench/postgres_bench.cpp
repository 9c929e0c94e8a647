// Durable reports of 8 KB a second into PostgreSQL by 1, 2 and 4 stores over one database, against
// pgbench's inserts of as many bytes into the same cluster, in turn; what a synchronous standby
// adds to a receipt. All on one disk and its processors: a store, the primary, the standby and the
// clients share them.
//
//   postgres_bench

#include <iostream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/bench/durable_reports.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/pgbench.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"

namespace kinship::store {
namespace {

constexpr std::size_t kTasks = 4;
constexpr int kRounds = 3;  // in turn, because the disk's own rate comes and goes
constexpr double kRound_s = 1.5;

/// Clients of some stores over one database, each with one report on its way.
class PostgresClients {
 public:
  explicit PostgresClients(const std::string& url, std::size_t stores) {
    for (std::size_t i = 0; i < stores; ++i)
      stores_.push_back(open_postgres_store(url));
    static_cast<void>(stores_.front()->register_robot(bench::reporting_robot()));
  }

  void run(std::size_t clients, bench::Seen& seen) {
    bench::run_reporters(
        clients, kRound_s, seen, [&](std::size_t client, std::mt19937_64& generator) {
          return bench::report_once(*stores_[client % stores_.size()],
                                    "bench_" + std::to_string(client % kTasks), generator);
        });
  }

 private:
  std::vector<std::unique_ptr<Store>> stores_;
};

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
  std::map<std::size_t, bench::Seen> seen;  // by the number of stores
  bench::Seen before;
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
                  .note = of_stores.latencies()});
}

void measure_receipts(bool has_standby) {
  const test::PostgresCluster primary(durable("a", has_standby ? "ANY 1 (b)" : ""));
  const std::string url = primary.create_database("bench");
  std::unique_ptr<test::PostgresCluster> standby;
  if (has_standby)
    standby = std::make_unique<test::PostgresCluster>(primary, durable("b", ""));
  PostgresClients clients(url, 1);
  bench::Seen before, seen;
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
