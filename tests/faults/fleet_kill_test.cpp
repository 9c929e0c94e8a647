#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/faults/fleet_reporter.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// kill -9 of kinshipd and of its clients at random instants, under load: whatever report() took is
/// in the store at the end, once. KINSHIP_LONG=1 kills 300 times.
namespace kinship::test::fleet_kill_test {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kSeed = 20261123;
constexpr std::size_t kClients = 5;  // the last two share an outbox

class FleetKill : public testing::Test {
 protected:
  void start_server() {
    server_ = std::make_unique<ServerProcess>(
        ServerProcess::Options{.store = store_, .domain = domain_.number()});
  }
  void start_client(std::size_t client) {
    constexpr std::uint64_t kNumbersPerLife = 10'000'000;
    const std::size_t outbox = std::min(client, kClients - 2);
    ledgers_.push_back(directory_ / ("ledger-" + std::to_string(ledgers_.size())).c_str());
    clients_.at(client) = std::make_unique<Program>(
        "../tests/faults_fleet",
        std::vector<std::string>{
            "report", std::to_string(domain_.number()),
            (directory_ / ("outbox-" + std::to_string(outbox)).c_str()).string(), ledgers_.back(),
            std::to_string(ledgers_.size() * kNumbersPerLife), "0"},
        directory_ / "clients.log");
  }
  void kill_one(std::mt19937_64& generator) {
    const auto pause = [&](unsigned most_ms) {
      std::this_thread::sleep_for(milliseconds(generator() % most_ms));  // the random instant
    };
    pause(1500);  // a new server's clients find it within a second
    if (generator() % 2 == 0) {
      server_->kill();
      pause(200);
      start_server();
      ++server_kills_;
      return;
    }
    const std::size_t victim = generator() % kClients;
    clients_.at(victim)->signal(SIGKILL);
    EXPECT_EQ(clients_.at(victim)->wait(), 128 + SIGKILL) << "it had ended by itself";
    start_client(victim);
  }
  void drain() {
    for (const auto& client : clients_)
      EXPECT_EQ(client->read_line(), "started");
    for (const auto& client : clients_)
      client->signal(SIGTERM);
    for (const auto& client : clients_) {
      EXPECT_EQ(client->read_line(), "pending 0 refused 0");
      EXPECT_EQ(client->wait(), 0) << read_text(directory_ / "clients.log");
    }
    EXPECT_EQ(server_->terminate(), 0);
  }
  ReportLedger read_ledgers() const {
    ReportLedger ledger;
    for (const std::string& file : ledgers_)
      ledger.read(file);
    return ledger;
  }

  ReservedDomain domain_;
  TemporaryDirectory directory_;
  const std::filesystem::path store_ = directory_ / "fleet.db";
  std::unique_ptr<ServerProcess> server_;
  std::vector<std::unique_ptr<Program>> clients_{kClients};
  std::vector<std::string> ledgers_;  // one a life of a client
  int server_kills_ = 0;
};

TEST_F(FleetKill, WhatWasReportedIsInTheStoreOnceWhoeverDies) {
  const int kills = is_long_run() ? 300 : 20;
  std::mt19937_64 generator(kSeed);
  start_server();
  for (std::size_t client = 0; client < kClients; ++client)
    start_client(client);
  for (int i = 0; i < kills; ++i)
    kill_one(generator);
  drain();

  const StoreCheck check = store::check_store(store_, [](double) {});
  EXPECT_EQ(check.problems, 0U) << (check.messages.empty() ? "" : check.messages.front());
  EXPECT_EQ(check.damaged_paths, 0U);
  const ReportLedger ledger = read_ledgers();
  const FleetAudit found =
      audit_fleet(*store::open_sqlite_store(store_), model_chain("panda").digest(), ledger);
  expect_nothing_wrong(found);
  EXPECT_GT(ledger.accepted.size(), 100U);
  std::cout << kills << " kills, " << server_kills_ << " of them of the server; accepted "
            << ledger.accepted.size() << " reports, stored " << found.stored << '\n';
}

}  // namespace
}  // namespace kinship::test::fleet_kill_test
