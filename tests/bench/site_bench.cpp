// A site that was cut off and has 20 000 reports waiting: what its robots notice while these go up.
// A receipt and a fetch from memory through Client, at the pace of robots, against the same while
// the line is down: kinshipd with SQLite, the memory a PostgreSQL that is frozen and thawed in
// turn.
//
//   site_bench shared   client, site and memory share all processors and the disk, which is more
//                       than a site has to bear
//   site_bench apart    as if the memory was on another machine: it has a processor of its own, in
//                       both halves, and its files are in memory

#include <sched.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;

constexpr std::uint64_t kWaiting = 20'000;
constexpr std::uint64_t kSweeps = 100;
constexpr int kRounds = 14;  // of each, in turn, and short: what else the machine does hits both
constexpr double kRound_s = 0.7;
constexpr double kPace_s = 0.005;  // of a report and a fetch

/// What a robot of the site waited for.
struct Seen {
  std::vector<double> receipts_ms, fetches_ms;
  double seconds = 0;
};

/// The processors that this program may use: the last one for a memory that is elsewhere, the
/// others for whatever is at the site.
class Processors {
 public:
  Processors() {
    CPU_ZERO(&all_);
    if (sched_getaffinity(0, sizeof(all_), &all_) != 0 || CPU_COUNT(&all_) < 2)
      throw std::runtime_error("site_bench apart: needs two processors");
  }

  /// From now on this thread, and the threads and processes that it starts, run there.
  void use_memorys() const {
    use([this](int processor) { return processor == last(); });
  }
  void use_sites() const {
    use([this](int processor) { return processor != last(); });
  }

 private:
  int last() const {
    int processor = CPU_SETSIZE - 1;
    while (!CPU_ISSET(static_cast<std::size_t>(processor), &all_))
      --processor;
    return processor;
  }

  template <typename IsWanted>
  void use(IsWanted is_wanted) const {
    cpu_set_t wanted;
    CPU_ZERO(&wanted);
    for (int processor = 0; processor < CPU_SETSIZE; ++processor)
      if (CPU_ISSET(static_cast<std::size_t>(processor), &all_) && is_wanted(processor))
        CPU_SET(static_cast<std::size_t>(processor), &wanted);
    if (sched_setaffinity(0, sizeof(wanted), &wanted) != 0)
      throw std::runtime_error("site_bench apart: sched_setaffinity");
  }

  cpu_set_t all_{};
};

/// The memory above, and from then on this thread is at the site.
std::unique_ptr<test::PostgresCluster> start_memory(bool is_apart) {
  if (!is_apart)
    return std::make_unique<test::PostgresCluster>(
        test::PostgresCluster::Options{.settings = {"fsync = on"}, .root = test::disk_root()});
  const Processors processors;
  processors.use_memorys();
  auto memory = std::make_unique<test::PostgresCluster>(
      test::PostgresCluster::Options{.settings = {"fsync = on"}, .root = test::memory_root()});
  processors.use_sites();
  return memory;
}

/// A site with its robot.
class Site {
 public:
  explicit Site(const std::string& memory) : memory_(memory) {
    start({});
    panda_ = bench::teach(*client_, kSweeps);
    server_.reset();
    wait_in_store();
    start({"--upstream", memory_});
  }

  UpstreamStatus upstream() {
    const AdminReply reply = client_->admin({}).value_or_throw();
    return json::row_from_json<ServerStatus>(reply.rows.at(0)).value_or_throw().upstream.value();
  }

  void run(Seen& seen) {
    const double begin_s = bench::wall_s();
    for (int i = 0; bench::wall_s() < begin_s + kRound_s; ++i) {
      Attempt attempt = next_report();
      double start_s = bench::wall_s();
      const auto receipts = client_->deliver({std::move(attempt)}).value_or_throw();
      seen.receipts_ms.push_back(1e3 * (bench::wall_s() - start_s));
      if (receipts.at(0).status != ReceiptStatus::Stored)
        throw std::runtime_error("site_bench: not stored: " + receipts[0].message);
      start_s = bench::wall_s();
      client_->fetch(bench::request_for(panda_)).value_or_throw();
      seen.fetches_ms.push_back(1e3 * (bench::wall_s() - start_s));
      const double due_s = begin_s + (i + 1) * kPace_s;
      std::this_thread::sleep_for(std::chrono::duration<double>(due_s - bench::wall_s()));
    }
    seen.seconds += bench::wall_s() - begin_s;
  }

 private:
  std::filesystem::path file() const { return folder_.path() / "site.db"; }

  void start(const std::vector<std::string>& arguments) {
    client_.reset();
    server_.reset();
    server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = file(), .domain = domain_.number(), .arguments = arguments});
    client_ = std::make_unique<link::Client>(bench::without_outbox(domain_.number()));
  }

  /// Of several tasks: of one it would be more than a robot may have.
  Attempt next_report() {
    constexpr std::uint64_t kTasks = 4;
    Attempt attempt = bench::report_of_8_kb(panda_, "beside", next_seed_);
    attempt.task += std::to_string(next_seed_++ % kTasks);
    return attempt;
  }

  /// As if robots had reported it since the line went down.
  void wait_in_store() {
    constexpr std::size_t kBatch = 500;
    const std::unique_ptr<store::Store> store = store::open_sqlite_store(file());
    while (next_seed_ < kWaiting) {
      std::vector<Attempt> attempts;
      while (attempts.size() < kBatch)
        attempts.push_back(next_report());
      test::report(*store, attempts);
    }
  }

  const test::TemporaryDirectory folder_{test::disk_root()};
  const std::string memory_;
  const test::ReservedDomain domain_;
  std::unique_ptr<test::ServerProcess> server_;
  std::unique_ptr<link::Client> client_;
  Digest panda_;
  std::uint64_t next_seed_ = 0;
};

void print(const std::string& what, const std::vector<double>& busy,
           const std::vector<double>& quiet) {
  for (const auto& [name, share] : {std::pair("p50", 0.5), std::pair("p99", 0.99)})
    bench::print({.name = what + " at a site that catches up, " + name,
                  .value = bench::percentile(busy, share),
                  .unit = "ms",
                  .reference = bench::Reference{"the same while it is cut off",
                                                bench::percentile(quiet, share)},
                  .ratio_budget = 1.5});
}

int run(bool is_apart) {
  if (const std::string missing = test::missing_postgres(); !missing.empty()) {
    std::cerr << "site_bench: " << missing << '\n';
    return 1;
  }
  const std::unique_ptr<test::PostgresCluster> memory = start_memory(is_apart);
  const std::string url = memory->create_database("memory");
  Site site(url);
  while (site.upstream().sent == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  Seen quiet, busy;
  std::uint64_t sent = 0;
  // A fast machine may have done with it before.
  for (int round = 0; round < kRounds && site.upstream().waiting > kWaiting / 4; ++round) {
    memory->freeze();
    site.run(quiet);
    memory->thaw();
    const std::uint64_t before = site.upstream().sent;
    site.run(busy);
    const UpstreamStatus now = site.upstream();
    if (!now.connected)
      throw std::runtime_error("site_bench: not connected: " + now.message);
    sent += now.sent - before;
  }
  print("receipt", busy.receipts_ms, quiet.receipts_ms);
  print("30 KB from memory", busy.fetches_ms, quiet.fetches_ms);
  bench::print({.name = "reports of 8 KB that go up while 20 000 wait",
                .value = static_cast<double>(sent) / busy.seconds,
                .unit = "reports/s",
                .better = bench::Better::Higher,
                .note = "the site rests three times as long as it works for them"});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string where = argc == 2 ? argv[1] : "";
  if (where != "shared" && where != "apart") {
    std::cerr << "site_bench shared|apart\n";
    return 2;
  }
  try {
    return run(where == "apart");
  } catch (const std::exception& exception) {
    std::cerr << exception.what() << '\n';
    return 1;
  }
}
