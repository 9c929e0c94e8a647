#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <functional>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/server_process.hpp"

/// Many clients, in processes of their own, whose server is killed and started again: how long they
/// are without an answer. A benchmark is this program again, with "clients" as its first argument.
namespace kinship::bench {

/// Asks with every client, on a thread each, until each has an answer.
inline void ask_with_all(const std::vector<std::unique_ptr<link::Client>>& clients,
                         const std::function<void(link::Client&)>& ask) {
  std::vector<std::jthread> threads;
  for (const auto& client : clients)
    threads.emplace_back([&client, &ask] { ask(*client); });
}

/// The work of a process of clients: asks, says so, waits for a signal, asks again and says so.
/// \param options  of each client.
/// \return an exit code.
inline int run_clients(int count, const link::ClientOptions& options,
                       const std::function<void(link::Client&)>& ask) {
  sigset_t start;
  sigemptyset(&start);
  sigaddset(&start, SIGUSR1);
  sigprocmask(SIG_BLOCK, &start, nullptr);  // threads inherit it
  std::vector<std::unique_ptr<link::Client>> clients;
  for (int i = 0; i < count; ++i)
    clients.push_back(std::make_unique<link::Client>(options));
  ask_with_all(clients, ask);
  std::cout << "connected" << std::endl;
  int received = 0;
  sigwait(&start, &received);
  std::cout << "asking" << std::endl;
  ask_with_all(clients, ask);
  std::cout << "answered" << std::endl;
  return 0;
}

using Processes = std::vector<std::unique_ptr<test::ChildProcess>>;

inline void expect(const Processes& processes, const std::string& line) {
  for (const auto& process : processes)
    if (process->read_line() != line)
      throw std::runtime_error("a process of clients has ended before '" + line + "'");
}

/// Prints how long they take to start and be answered, and to be answered by a server that was
/// killed, from its new start on.
/// \param who        of the figures' names, e.g. "1000 clients".
/// \param domain     of the server.
/// \param arguments  one process of clients each: what it is told behind "clients" and the domain.
/// \return the processes, which end now.
inline Processes measure_restart(const std::string& who, std::uint32_t domain,
                                 const std::vector<std::string>& arguments,
                                 std::unique_ptr<test::ServerProcess>& server,
                                 const test::ServerProcess::Options& options) {
  double start_s = wall_s();
  Processes processes;
  for (const std::string& argument : arguments)
    processes.push_back(std::make_unique<test::ChildProcess>(
        std::vector<std::string>{"/proc/self/exe", "clients", std::to_string(domain), argument}));
  expect(processes, "connected");
  const double first_s = wall_s() - start_s;
  print({.name = who + " start and are answered", .value = first_s, .unit = "s"});
  server->kill();
  for (const auto& process : processes)
    process->signal(SIGUSR1);
  expect(processes, "asking");
  start_s = wall_s();
  server = std::make_unique<test::ServerProcess>(options);
  expect(processes, "answered");
  print({.name = who + " answered after the server's start",
         .value = wall_s() - start_s,
         .unit = "s",
         .reference = Reference{"they start", first_s},
         .ratio_budget = 1});
  return processes;
}

}  // namespace kinship::bench
