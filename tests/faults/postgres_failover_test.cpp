#include <gtest/gtest.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/faults/report_history.hpp"
#include "tests/faults/store_fleet.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"

/// The primary's host is lost with what it had not sent, again and again; servers and clients go on
/// with the standby. KINSHIP_LONG=1: 8 servers with 100 clients each, 50 failovers.
namespace kinship::test::postgres_failover_test {
namespace {

constexpr std::uint64_t kSeed = 20261126;
constexpr const char* kDatabase = "fleet";

class PostgresFailover : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    primary_ = std::make_unique<PostgresCluster>(PostgresCluster::Options{
        .name = "a", .settings = {"synchronous_standby_names = 'ANY 1 (a, b, c)'"}});
    primary_->create_database(kDatabase);
    standby_ = std::make_unique<PostgresCluster>(*primary_, PostgresCluster::Options{.name = "b"});
    url_ = url_of_either(*primary_, *standby_, kDatabase);
    fleet_ = std::make_unique<StoreFleet>(
        is_long_run() ? StoreFleet::Options{.servers = 8, .clients = 100, .requires_standby = true}
                      : StoreFleet::Options{.servers = 2, .clients = 4, .requires_standby = true});
    fleet_->start_all(url_);
  }

  std::uint64_t a_while() { return 1 + generator_() % (is_long_run() ? 2000 : 60); }

  /// Half of the time the standby is behind when it happens: a store that does not wait for it
  /// answers meanwhile.
  void lose_the_primary() {
    if (generator_() % 2 == 0) {
      standby_->freeze_receiver();
      fleet_->wait_for_answers(1000, std::chrono::milliseconds(100));
    }
    lose_primary(*primary_, *standby_);
    standby_->promote();
    std::swap(primary_, standby_);
  }
  /// In the end, with a new server.
  HistoryFaults faults() {
    EXPECT_TRUE(fleet_->end()) << fleet_->log();
    const std::vector<HistoryEntry> history = fleet_->history();
    std::cout << answered_reports(history).size() << " reports with a receipt\n";
    return find_faults(*store::open_postgres_store(url_), history);
  }

  std::mt19937_64 generator_{kSeed};
  std::unique_ptr<PostgresCluster> primary_, standby_;
  std::string url_;
  std::unique_ptr<StoreFleet> fleet_;
};

TEST_F(PostgresFailover, ReceiptsOutlivePrimariesAndNoGenerationGoesBack) {
  const int failovers = is_long_run() ? 50 : 3;
  for (int i = 0; i < failovers; ++i) {
    ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
    lose_the_primary();
    if (i % 3 == 1) {
      const std::size_t victim = generator_() % fleet_->size();
      fleet_->kill(victim);
      fleet_->start(victim, url_);
    }
    standby_->rewind_and_follow(*primary_);
  }
  ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
  EXPECT_EQ(faults(), HistoryFaults{}) << fleet_->log();
}

TEST_F(PostgresFailover, AnOldPrimaryThatComesBackTakesNoReceiptWithIt) {
  ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
  lose_the_primary();
  const PostgresCluster third(*primary_, {.name = "c"});
  ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();

  // Two primaries now: the old one too is in the servers' list, takes writes, and has no standby.
  standby_->start();
  ASSERT_EQ(standby_->query("SELECT pg_is_in_recovery()"), "f");
  fleet_->kill(0);
  fleet_->start(0, url_);  // may well find the old one
  ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
  EXPECT_EQ(find_faults(*store::open_postgres_store(primary_->url(kDatabase)), {}).repeated, 0U);

  standby_->kill();
  standby_->rewind_and_follow(*primary_);
  ASSERT_TRUE(fleet_->wait_for_answers(a_while())) << fleet_->log();
  EXPECT_EQ(faults(), HistoryFaults{}) << fleet_->log();
}

}  // namespace
}  // namespace kinship::test::postgres_failover_test
