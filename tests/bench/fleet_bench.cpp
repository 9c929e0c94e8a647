// Several kinshipd as processes over one PostgreSQL database, with clients over DDS: durable
// reports of 8 KB a second by 1, 2 and 4 servers against pgbench's inserts of as many bytes into
// the same cluster; a fetch from memory against that of a server over an SQLite file; how soon a
// server that joins answers. Servers, database and clients share one disk and its processors.
//
//   fleet_bench

#include <future>
#include <iostream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/pgbench.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kPaths = 100;
constexpr double kRound_s = 3;
constexpr int kRounds = 3;  // in turn, because the disk's own rate comes and goes

/// kinshipd with a domain of its own, as a process.
class Server {
 public:
  Server(const std::string& store, const std::filesystem::path& log)
      // It measures what a server can, not what one client may.
      : process_({.store = store,
                  .domain = domain_.number(),
                  .arguments = {"--client-mb-per-s", "0", "--client-attempts-per-s", "0"},
                  .log = log}) {}

  std::uint32_t domain() const { return domain_.number(); }

 private:
  const test::ReservedDomain domain_;
  const test::ServerProcess process_;
};

/// Reports a second of four clients at each of the servers, all at once.
/// \param shares_task  all of them report the same task of the same robot, which is one row for
/// all.
double reports_per_s(const std::vector<std::unique_ptr<Server>>& servers, std::size_t count,
                     const Digest& robot, bool shares_task) {
  std::vector<std::future<double>> reports;
  for (std::size_t i = 0; i < count; ++i)
    reports.push_back(std::async(std::launch::async, [&, i] {
      const std::string task = shares_task ? "shared" : "of_server_" + std::to_string(i);
      return std::stod(
          start_role("reports", servers[i]->domain(), robot, {"0", std::to_string(kRound_s), task})
              .read_line());
    }));
  double all = 0;
  for (std::future<double>& of_one : reports)
    all += of_one.get();
  if (all == 0)
    throw std::runtime_error("no report was stored");
  return all / kRound_s;
}

void measure_reports(const test::PostgresCluster& cluster,
                     const std::vector<std::unique_ptr<Server>>& servers, const Digest& robot) {
  const std::vector<std::size_t> counts = {1, 2, 4};
  prepare_pgbench(cluster, "fleet");
  reports_per_s(servers, 1, robot, true);
  cluster.query("ANALYZE", "fleet");  // as autovacuum does within a minute
  std::map<std::size_t, std::vector<double>> inserts, own, shared;
  for (int round = 0; round < kRounds; ++round)
    for (const std::size_t count : counts) {
      inserts[count].push_back(
          pgbench_inserts_per_s(cluster, "fleet", static_cast<int>(4 * count), kRound_s));
      own[count].push_back(reports_per_s(servers, count, robot, false));
      if (count > 1)
        shared[count].push_back(reports_per_s(servers, count, robot, true));
    }
  const auto tell = [&](std::size_t count, const std::string& tasks,
                        const std::vector<double>& rates) {
    print({.name = "durable reports of 8 KB over DDS, 4 clients at each of " +
                   std::to_string(count) + (count == 1 ? " server" : " servers" + tasks),
           .value = median(rates),
           .unit = "reports/s",
           .better = Better::Higher,
           .reference =
               Reference{"pgbench's inserts of 8 KB, as many clients", median(inserts[count])}});
  };
  for (const std::size_t count : counts)
    tell(count, ", each its own task", own[count]);
  for (const auto& [count, rates] : shared)
    tell(count, ", one task of one robot for all", rates);
}

void measure_fetches(std::uint32_t domain, std::uint32_t sqlite_domain, const Digest& robot) {
  constexpr int kBlock = 100, kBlocks = 30;
  link::Client client(without_outbox(domain)), beside(without_outbox(sqlite_domain));
  std::vector<double> ours_us, beside_us;
  const auto measure = [&](link::Client& asked, std::vector<double>& times_us) {
    for (int i = 0; i < kBlock; ++i)
      times_us.push_back(
          1e6 * least_s(1, wall_s, [&] { asked.fetch(request_for(robot)).value_or_throw(); }));
  };
  for (int block = 0; block < kBlocks; ++block) {
    measure(client, ours_us);
    measure(beside, beside_us);
  }
  for (const auto& [name, share] : {std::pair("p50", 0.5), std::pair("p99", 0.99)})
    print({.name = "30 KB from memory, " + std::string(name),
           .value = percentile(ours_us, share),
           .unit = "us",
           .reference = Reference{"a server over an SQLite file", percentile(beside_us, share)}});
}

/// From the start of a server's process to its first answer, of a distribution that is stored.
double first_answer_ms(const std::string& store, const std::filesystem::path& log,
                       const Digest& robot) {
  const double start_s = wall_s();
  const Server server(store, log);
  link::Client client(without_outbox(server.domain()));
  const FetchReply reply = client.fetch(request_for(robot)).value_or_throw();
  if (reply.status != FetchStatus::Ready || reply.distribution->revision != 1)
    throw std::runtime_error("a server that starts does not give what is there: " + reply.message);
  return 1e3 * (wall_s() - start_s);
}

/// A server that joins others, beside one that starts again over a file of its own.
void measure_joining(const std::string& url, const std::filesystem::path& folder,
                     const Digest& robot) {
  constexpr int kServers = 5;
  const std::string file = folder / "again.db";
  {
    const Server server(file, folder / "log-again");
    link::Client client(without_outbox(server.domain()));
    teach(client, kPaths);
  }
  std::vector<double> times_ms, again_ms;
  for (int i = 0; i < kServers; ++i) {
    times_ms.push_back(first_answer_ms(url, folder / ("joining-" + std::to_string(i)), robot));
    again_ms.push_back(first_answer_ms(file, folder / ("again-" + std::to_string(i)), robot));
  }
  print({.name = "a server joins: from its start to its first answer",
         .value = median(times_ms),
         .unit = "ms",
         .reference = Reference{"a server over an SQLite file starts again", median(again_ms)},
         .ratio_budget = 1.5,
         .note = "of 5, the longest " + std::to_string(static_cast<int>(percentile(times_ms, 1))) +
                 " ms"});
}

void run() {
  const test::TemporaryDirectory folder{test::disk_root()};
  const test::PostgresCluster cluster({.settings = {"fsync = on"}, .root = test::disk_root()});
  const std::string url = cluster.create_database("fleet");
  std::vector<std::unique_ptr<Server>> servers;
  for (int i = 0; i < 4; ++i)
    servers.push_back(std::make_unique<Server>(url, folder.path() / ("log-" + std::to_string(i))));
  const Server sqlite(folder / "fleet.db", folder / "log-sqlite");
  Digest panda;
  for (const std::uint32_t domain : {servers[0]->domain(), sqlite.domain()}) {
    link::Client client(without_outbox(domain));
    panda = teach(client, kPaths);
  }
  measure_joining(url, folder.path(), panda);
  measure_fetches(servers[0]->domain(), sqlite.domain(), panda);
  measure_reports(cluster, servers, panda);
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  if (kinship::bench::run_role({argv + 1, argv + argc}))
    return 0;
  if (const std::string missing = kinship::test::missing_postgres(); !missing.empty()) {
    std::cerr << "fleet_bench: " << missing << '\n';
    return 1;
  }
  kinship::bench::run();
}
