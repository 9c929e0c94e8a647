#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/unit/server/store/postgres/empty_store.hpp"

/// Rows that every report, fit or second of a server writes anew: in place (HOT), so that neither
/// they nor their indexes grow between two runs of vacuum, nor with it.
namespace kinship::store::postgres::hot_updates_test {
namespace {

using HotUpdates = EmptyStore;

TEST_F(HotUpdates, WhatEachReportWritesAnewStaysInItsPages) {
  constexpr std::uint64_t kReports = 400;
  const RobotRecord robot = test::make_robot("panda", 1);
  if (std::getenv("FILL"))
    connection_->query("ALTER TABLE attempt SET (fillfactor = " + std::string(std::getenv("FILL")) + ")");
  connection_->query("ALTER TABLE run SET (autovacuum_enabled = off)");
  connection_->query("ALTER TABLE experience SET (autovacuum_enabled = off)");
  connection_->query("ALTER TABLE attempt SET (autovacuum_enabled = off)");
  connection_->query("ALTER TABLE fit_lease SET (autovacuum_enabled = off)");
  std::unique_ptr<Store> store = open_postgres_store(url_);
  static_cast<void>(store->register_robot(robot));
  for (std::uint64_t number = 1; number <= kReports; ++number) {
    const Attempt attempt = test::make_attempt(robot.digest, "shelf", number);
    test::report(*store, {attempt});
    test::report(*store, {attempt});  // as if its answer were lost
    const Digest id = test::id_from<Digest>(number % 10);
    store->give_back_fit_right(id, store->take_fit_right(id).value_or(FitRight{}));
  }
  for (int again = 0; again < 2; ++again)
    for (std::uint64_t number = 1; number <= kReports; ++number)
      test::report(*store, {test::make_attempt(robot.digest, "shelf", number)});
  store.reset();  // its sessions tell the statistics what they did when they end
  const Rows tables = connection_->query(
      "SELECT relname::text, n_tup_upd, n_tup_hot_upd, pg_relation_size(relid)"
      " FROM pg_stat_user_tables WHERE n_tup_upd > 100 ORDER BY relname");
  for (const Row table : tables)
    std::cout << table.column_text(0) << " " << table.column_integer(1) << " "
              << table.column_integer(2) << " " << table.column_integer(3) << "\n";
}

}  // namespace
}  // namespace kinship::store::postgres::hot_updates_test
