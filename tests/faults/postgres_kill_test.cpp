#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <random>
#include <string>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/faults/report_history.hpp"
#include "tests/faults/store_fleet.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/pgbouncer.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"

/// Several servers over one database; any of them, their connections and the database's processes
/// are killed at random instants. KINSHIP_LONG=1: 8 servers with 100 clients each, 200 faults.
namespace kinship::test::postgres_kill_test {
namespace {

constexpr std::uint64_t kSeed = 20261125;

class PostgresKill : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = missing_pgbouncer(); !missing.empty())
      GTEST_SKIP() << missing;
    cluster_ = std::make_unique<PostgresCluster>();
    url_ = cluster_->create_database("fleet");
    fleet_ = std::make_unique<StoreFleet>(
        is_long_run() ? StoreFleet::Options{.servers = 8, .clients = 100, .requires_standby = false}
                      : StoreFleet::Options{.servers = 3, .clients = 4, .requires_standby = false});
  }

  std::size_t faults() const { return is_long_run() ? 200 : 8; }
  std::uint64_t a_while() { return 1 + generator_() % (is_long_run() ? 2000 : 60); }

  void kill_a_server(const std::string& url) {
    const std::size_t victim = generator_() % fleet_->size();
    fleet_->kill(victim);
    fleet_->start(victim, url);
  }
  void cut_connections() {
    cluster_->query(
        "SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity "
        "WHERE datname = 'fleet' AND pid <> pg_backend_pid() AND random() < 0.5",
        "fleet");
  }
  void expect_no_fault() {
    EXPECT_TRUE(fleet_->end()) << fleet_->log();
    const std::vector<HistoryEntry> history = fleet_->history();
    EXPECT_EQ(find_faults(*store::open_postgres_store(url_), history), HistoryFaults{})
        << fleet_->log();
    std::cout << answered_reports(history).size() << " reports with a receipt\n";
  }

  std::mt19937_64 generator_{kSeed};
  std::unique_ptr<PostgresCluster> cluster_;
  std::string url_;
  std::unique_ptr<StoreFleet> fleet_;
};

TEST_F(PostgresKill, ReceiptsOutliveServersConnectionsAndADatabaseThatIsKilled) {
  fleet_->start_all(url_);
  for (std::size_t i = 0; i < faults(); ++i) {
    ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
    if (i % 4 == 3) {
      cluster_->kill();
      cluster_->start();
    } else if (i % 4 == 1) {
      cut_connections();
    } else {
      kill_a_server(url_);
    }
  }
  ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
  expect_no_fault();
}

TEST_F(PostgresKill, APoolerThatSharesConnectionsBetweenServersLosesNothing) {
  PgBouncer bouncer(*cluster_, 3);
  fleet_->start_all(bouncer.url("fleet"));
  for (std::size_t i = 0; i < faults() / 2; ++i) {
    ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
    if (i % 2 == 0) {
      kill_a_server(bouncer.url("fleet"));
    } else {
      bouncer.kill();
      bouncer.restart();
    }
  }
  ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
  expect_no_fault();
}

}  // namespace
}  // namespace kinship::test::postgres_kill_test
