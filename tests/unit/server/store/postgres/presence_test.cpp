// What servers of one database know of each other: what others changed, and who fits what.

#include <gtest/gtest.h>

#include <algorithm>
#include <future>
#include <memory>
#include <set>

#include "proto/types/failure.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/postgres_store.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"
#include "tests/unit/server/store/postgres/fresh_database.hpp"
#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store::presence_test {
namespace {

class PostgresPresence : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    url_ = FreshDatabases::of_program().url(folder_.path());
    one_ = open_postgres_store(url_, {});
    other_ = open_postgres_store(url_, {});
    EXPECT_TRUE(one_->register_robot(robot_));
    EXPECT_TRUE(one_->register_robot(arm_));
    distribution_ = test::make_distribution(robot_.digest, "shelf", 3);
  }

  std::string sql(const std::string& text) const { return test::query_postgres(url_, text); }
  void report(std::uint64_t number, const std::string& task = "shelf") {
    test::report(*one_, {test::make_attempt(robot_.digest, task, number)});
  }
  /// What the other server is told; it has looked up to now afterwards.
  StoreChanges look() {
    StoreChanges changes = other_->changes_since(cursor_).value();
    cursor_ = changes.cursor;
    return changes;
  }
  static std::set<std::string> tasks_of(const StoreChanges& changes) {
    std::set<std::string> tasks;
    for (const ChangedExperience& pair : changes.experience)
      tasks.insert(pair.task);
    return tasks;
  }
  /// As if it had been killed long ago: nobody has heard of the servers since.
  void let_servers_die() const { sql("UPDATE server SET alive_until = now() - interval '1 s'"); }

  const test::TemporaryDirectory folder_;
  const RobotRecord robot_ = test::make_robot("panda", 1), arm_ = test::make_robot("iiwa", 2);
  Distribution distribution_;
  std::string url_, cursor_;
  std::unique_ptr<Store> one_, other_;
};

TEST_F(PostgresPresence, WhoLooksIsToldWhatAnybodyChangedSinceAndNothingBefore) {
  report(1);
  one_->put_distribution(distribution_, {});
  StoreChanges changes = look();  // the first time
  EXPECT_TRUE(changes.experience.empty() && changes.robots.empty() && changes.evicted.empty());
  changes = look();
  EXPECT_TRUE(changes.experience.empty() && changes.robots.empty() && changes.evicted.empty());

  report(2, "table");
  EXPECT_TRUE(*one_->rename_robot(robot_.digest, "arm-7", nullptr));
  EXPECT_TRUE(one_->evict_distribution(distribution_.id, nullptr));
  changes = look();
  ASSERT_EQ(tasks_of(changes), std::set<std::string>{"table"});
  EXPECT_EQ(changes.experience[0].now.robot, robot_.digest);
  EXPECT_EQ(changes.experience[0].now.paths, 1U);
  EXPECT_EQ(changes.experience[0].now.generation, 1U);
  EXPECT_EQ(changes.robots, std::vector{robot_.digest});
  EXPECT_EQ(changes.evicted, std::vector{distribution_.id});

  static_cast<void>(one_->reset_task("shelf"));
  EXPECT_TRUE(one_->remove_robot(arm_.digest));  // leaves no row
  changes = look();
  ASSERT_EQ(tasks_of(changes), std::set<std::string>{"shelf"});
  EXPECT_EQ(changes.experience[0].now.retired_generation, 2U);
  EXPECT_EQ(changes.robots, std::vector{arm_.digest});
}

TEST_F(PostgresPresence, WhatBeganSoonerAndIsCommittedLaterIsTold) {
  report(1);
  static_cast<void>(look());
  postgres::Connection slow{postgres::ConnectionString(url_)};
  slow.query("BEGIN");
  slow.query("UPDATE robot SET changed_in = pg_current_xact_id() WHERE label = 'iiwa'");
  report(2);  // begins after that, and is committed before
  StoreChanges changes = look();
  EXPECT_EQ(tasks_of(changes), std::set<std::string>{"shelf"});
  EXPECT_TRUE(changes.robots.empty());
  slow.query("COMMIT");
  changes = look();
  EXPECT_EQ(changes.robots, std::vector{arm_.digest});
  EXPECT_EQ(changes.experience.at(0).now.generation, 2U) << "told twice at worst";
}

TEST_F(PostgresPresence, ReportsAreStoredAlsoIfTheirTaskIsRenamedMeanwhile) {
  report(1, "lod");
  postgres::Connection slow{postgres::ConnectionString(url_)};
  slow.query("BEGIN");
  slow.query("INSERT INTO task (name) VALUES ('new')");
  // Holds them up between the look for their tasks and that for their pairs.
  auto receipts = std::async(std::launch::async, [&] {
    return test::report(*one_, {test::make_attempt(robot_.digest, "lod", 2),
                                test::make_attempt(robot_.digest, "new", 3)});
  });
  test::wait_until_true(url_, "SELECT count(*) = 1 FROM pg_locks WHERE NOT granted");
  ASSERT_TRUE(other_->rename_task("lod", "load"));
  slow.query("ROLLBACK");
  for (const Receipt& receipt : receipts.get())
    EXPECT_EQ(receipt.status, ReceiptStatus::Stored) << receipt.message;
  EXPECT_EQ(one_->find_task("load")->paths, 1U);
  EXPECT_EQ(one_->find_task("lod")->paths, 1U) << "named by a report after its renaming";
}

TEST_F(PostgresPresence, ARenamedTaskIsToldUnderBothNames) {
  report(1, "lod");
  report(2, "table");
  static_cast<void>(look());
  static_cast<void>(look());
  ASSERT_TRUE(one_->rename_task("lod", "load"));
  StoreChanges changes = look();
  EXPECT_EQ(changes.former_tasks, std::vector<std::string>{"lod"});
  ASSERT_EQ(tasks_of(changes), std::set<std::string>{"load"});
  EXPECT_EQ(changes.experience[0].now.generation, 2U);
  EXPECT_EQ(changes.experience[0].now.retired_generation, 2U);
  EXPECT_TRUE(look().former_tasks.empty());
  ASSERT_TRUE(one_->rename_task("load", "lod"));
  ASSERT_TRUE(one_->rename_task("lod", "load"));
  changes = look();
  EXPECT_EQ(changes.former_tasks.size(), 2U) << "a name may be given up again";
}

TEST_F(PostgresPresence, ACursorOfSomethingElseIsRefused) {
  for (const char* const cursor : {"1; DROP", "1", ".", "1.", ".1", "1.1.1", "1.-1"})
    EXPECT_THROW(static_cast<void>(other_->changes_since(cursor)), Failure) << cursor;
}

TEST_F(PostgresPresence, WhoLookedAtAnotherPrimaryIsToldEverything) {
  report(1);
  const std::string cursor = look().cursor;
  ASSERT_TRUE(cursor.starts_with("1."));
  const StoreChanges changes = other_->changes_since("2" + cursor.substr(1)).value();
  EXPECT_EQ(tasks_of(changes), std::set<std::string>{"shelf"});
  EXPECT_EQ(changes.robots.size(), 2U);
}

TEST_F(PostgresPresence, OneServerAtATimeMayFitADistribution) {
  const FitRight right = one_->take_fit_right(distribution_.id).value();
  EXPECT_EQ(right.fence, 1U);
  EXPECT_FALSE(other_->take_fit_right(distribution_.id));
  EXPECT_TRUE(other_->take_fit_right(test::id_from<Digest>(4))) << "another one is free";
  other_->give_back_fit_right(distribution_.id, {.fence = 2});  // not its own: nothing happens
  EXPECT_FALSE(other_->take_fit_right(distribution_.id));
  one_->give_back_fit_right(distribution_.id, right);
  EXPECT_EQ(other_->take_fit_right(distribution_.id).value().fence, 2U);
  EXPECT_FALSE(one_->take_fit_right(distribution_.id));
}

TEST_F(PostgresPresence, TheRightOfAServerThatDiedIsFreeAndWhatItStoresAfterwardsIsNotTaken) {
  report(1);
  const FitRight lost = one_->take_fit_right(distribution_.id).value();
  let_servers_die();
  const FitRight right = other_->take_fit_right(distribution_.id).value();
  EXPECT_GT(right.fence, lost.fence);
  try {
    one_->put_distribution(distribution_, lost);
    ADD_FAILURE() << "stored by a server that has no right";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Unavailable);
    EXPECT_NE(std::string(failure.what()).find("another server fits it"), std::string::npos);
  }
  EXPECT_FALSE(one_->find_distribution(distribution_.id));
  one_->give_back_fit_right(distribution_.id, lost);  // neither is that of the other given back
  EXPECT_EQ(other_->put_distribution(distribution_, right), 1U);
}

TEST_F(PostgresPresence, AServerThatGoesOnLookingKeepsItsRight) {
  EXPECT_TRUE(one_->take_fit_right(distribution_.id));
  let_servers_die();
  while (sql("SELECT bool_or(alive_until > now()) FROM server") != "t")
    static_cast<void>(one_->changes_since(""));
  EXPECT_FALSE(other_->take_fit_right(distribution_.id));
}

}  // namespace
}  // namespace kinship::store::presence_test
