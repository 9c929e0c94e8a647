// 1000 clients whose server is killed and started again: until the last of them has its
// distribution, and what that takes of the server's memory. The clients are ten processes, each
// with a hundred participants on threads of their own.
//
//   many_clients_bench

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/load_clients.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/process_figures.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;

constexpr int kProcesses = 10;
constexpr int kClientsOfProcess = 100;

/// Fetches with every client until each has an answer.
void fetch_with_all(const std::vector<std::unique_ptr<link::Client>>& clients,
                    const Digest& robot) {
  std::vector<std::jthread> threads;
  for (const auto& client : clients)
    threads.emplace_back([&client, &robot] {
      if (client->fetch(bench::request_for(robot)).value_or_throw().status != FetchStatus::Ready)
        std::exit(1);
    });
}

sigset_t start_signal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGUSR1);
  return signals;
}

/// Fetches, says so, waits for a signal, fetches again and says so.
int run_clients(std::uint32_t domain, const Digest& robot) {
  const sigset_t signals = start_signal();
  sigprocmask(SIG_BLOCK, &signals, nullptr);  // threads inherit it
  std::vector<std::unique_ptr<link::Client>> clients;
  for (int i = 0; i < kClientsOfProcess; ++i)
    clients.push_back(std::make_unique<link::Client>(bench::without_outbox(domain)));
  fetch_with_all(clients, robot);
  std::cout << "connected" << std::endl;
  int received = 0;
  sigwait(&signals, &received);
  std::cout << "asking" << std::endl;
  fetch_with_all(clients, robot);
  std::cout << "answered" << std::endl;
  return 0;
}

using Processes = std::vector<std::unique_ptr<test::ChildProcess>>;

void expect(const Processes& processes, const std::string& line) {
  for (const auto& process : processes)
    if (process->read_line() != line)
      throw std::runtime_error("a process of clients has ended before '" + line + "'");
}

void run() {
  const test::ReservedDomain domain;
  const test::TemporaryDirectory directory{test::disk_root()};
  const test::ServerProcess::Options options{
      .store = directory / "fleet.db", .domain = domain.number(), .arguments = {}};
  auto server = std::make_unique<test::ServerProcess>(options);
  Digest panda;
  {
    link::Client client(bench::without_outbox(domain.number()));
    panda = bench::teach(client, 100);
  }
  Processes processes;
  double start_s = bench::wall_s();
  for (int i = 0; i < kProcesses; ++i)
    processes.push_back(std::make_unique<test::ChildProcess>(std::vector<std::string>{
        "/proc/self/exe", "clients", std::to_string(domain.number()), panda.hex()}));
  expect(processes, "connected");
  bench::print({.name = "1000 clients start and are answered",
                .value = bench::wall_s() - start_s,
                .unit = "s"});
  server->kill();
  for (const auto& process : processes)
    process->signal(SIGUSR1);
  expect(processes, "asking");
  start_s = bench::wall_s();
  server = std::make_unique<test::ServerProcess>(options);
  expect(processes, "answered");
  bench::print({.name = "1000 clients answered after the server's start",
                .value = bench::wall_s() - start_s,
                .unit = "s",
                .budget = 3});
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
