// 1000 clients whose server is killed and started again: until the last of them has its
// distribution, and what that takes of the server's memory. The clients are ten processes, each
// with a hundred participants on threads of their own.
//
//   many_clients_bench

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/restarted_clients.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/process_figures.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;

constexpr int kProcesses = 10;
constexpr int kClientsOfProcess = 100;

int run_clients(std::uint32_t domain, const Digest& robot) {
  return bench::run_clients(
      kClientsOfProcess, bench::without_outbox(domain), [&robot](link::Client& client) {
        if (client.fetch(bench::request_for(robot)).value_or_throw().status != FetchStatus::Ready)
          std::exit(1);
      });
}

void run() {
  const test::ReservedDomain domain;
  const test::TemporaryDirectory directory{test::disk_root()};
  const test::ServerProcess::Options options{.store = directory / "fleet.db",
                                             .domain = domain.number()};
  auto server = std::make_unique<test::ServerProcess>(options);
  Digest panda;
  {
    link::Client client(bench::without_outbox(domain.number()));
    panda = bench::teach(client, 100);
  }
  const bench::Processes processes =
      bench::measure_restart("1000 clients", domain.number(),
                             std::vector<std::string>(kProcesses, panda.hex()), server, options);
  bench::print({.name = "resident size of the server",
                .value = test::figures_of(server->pid()).resident_mb,
                .unit = "MB",
                .budget = 200});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "clients")
    return run_clients(static_cast<std::uint32_t>(std::stoul(argv[2])),
                       Digest::from_hex(argv[3]).value());
  run();
  return 0;
}
