#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "server/store/postgres/postgres_store.hpp"
#include "tests/support/postgres_query.hpp"
#include "tests/support/store_values.hpp"
#include "tests/unit/server/store/postgres/empty_store.hpp"

/// Rows that reports, resends and fits write anew: in their page (HOT), where room is made without
/// vacuum and no index has another entry, so that none of it grows with what is written.
namespace kinship::store::postgres::hot_updates_test {
namespace {

struct Updates {
  std::int64_t all = 0, in_page = 0, bytes = 0;
};

class HotUpdates : public EmptyStore {
 protected:
  void SetUp() override {
    EmptyStore::SetUp();
    if (IsSkipped())
      return;
    for (const char* const table : {"run", "experience", "attempt", "fit_lease"})
      connection_->execute(std::string("ALTER TABLE ") + table + " SET (autovacuum_enabled = off)");
    store_ = open_postgres_store(url_);
    ASSERT_TRUE(store_->register_robot(robot_));
  }
  void report(std::uint64_t number) {
    test::report(*store_, {test::make_attempt(robot_.digest, "shelf", number)});
  }
  /// By table. A session tells the statistics what it did when it ends, at the latest.
  std::map<std::string, Updates> updates() {
    store_.reset();
    test::wait_until_true(url_,
                          "SELECT count(*) = 2 FROM pg_stat_activity"
                          " WHERE datname = current_database()");  // this one, and connection_
    std::map<std::string, Updates> tables;
    for (const Row row : connection_->query("SELECT relname::text, n_tup_upd, n_tup_hot_upd,"
                                            " pg_relation_size(relid) FROM pg_stat_user_tables"))
      tables[std::string(row.column_text(0))] = {row.column_integer(1), row.column_integer(2),
                                                 row.column_integer(3)};
    return tables;
  }

  std::unique_ptr<Store> store_;
  const RobotRecord robot_ = test::make_robot("panda", 1);
};

TEST_F(HotUpdates, WhatIsWrittenAnewAllTheTimeStaysInItsPage) {
  constexpr std::int64_t kReports = 300, kPage = 8192;
  for (std::uint64_t number = 1; number <= kReports; ++number) {
    report(number);
    const Digest id = test::id_from<Digest>(number % 10);
    const std::optional<FitRight> right = store_->take_fit_right(id);
    ASSERT_TRUE(right);
    store_->give_back_fit_right(id, *right);
  }
  for (std::uint64_t number = 1; number <= kReports; ++number)
    report(number);  // whose answers were lost, long ago: their pages are full
  std::map<std::string, Updates> written = updates();
  EXPECT_GE(written["run"].all, 2 * kReports);
  EXPECT_GE(written["experience"].all, kReports);
  EXPECT_GE(written["fit_lease"].all, 2 * kReports - 10);
  EXPECT_GE(written["attempt"].all, kReports);
  for (const char* const table : {"run", "experience", "fit_lease"}) {
    EXPECT_EQ(written[table].in_page, written[table].all) << table;
    EXPECT_EQ(written[table].bytes, kPage) << table;
  }
  // Where a page has no room the first one goes to another; those after it have room.
  EXPECT_GE(written["attempt"].in_page * 10, written["attempt"].all * 8);
}

}  // namespace
}  // namespace kinship::store::postgres::hot_updates_test
