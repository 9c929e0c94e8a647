#include <gtest/gtest.h>
#include <sqlite3.h>

#include <string>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "tests/faults/store_session.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/next_schema.hpp"
#include "tests/support/places.hpp"

/// A power cut at any change of the disk: every acknowledged report is there afterwards, once, and
/// readable; a backup has its name when it is whole. KINSHIP_LONG=1 cuts twelve times as often.
namespace kinship::store::store_power_loss_test {
namespace {

using test::DiskCall;
using test::StoreSession;

constexpr std::uint64_t kSeed = 20261123;

std::uint64_t rounds(std::uint64_t usual) { return test::is_long_run() ? 12 * usual : usual; }

std::string golden() { return test::source_dir() + "/tests/golden/store-1.db"; }

/// What the cuts of some sessions lost.
class StorePowerLoss : public testing::Test {
 protected:
  void look_at(StoreSession& session) {
    for (const std::string& loss : session.find_losses()) {
      ++losses_;
      last_ = loss;
    }
    cuts_ += session.cuts();
  }
  /// Does `work` in so many sessions, or in twelve times as many.
  template <typename Work>
  void expect_no_loss(std::uint64_t sessions, std::uint64_t mean_gap, const Work& work,
                      const std::string& golden = {}) {
    for (std::uint64_t round = 0; round < rounds(sessions); ++round) {
      StoreSession session(kSeed + round, mean_gap, golden);
      work(session, round);
      look_at(session);
    }
    RecordProperty("cuts", static_cast<int>(cuts_));
    EXPECT_EQ(losses_, 0U) << "of " << cuts_ << " cuts; the last: " << last_;
  }
  std::size_t cuts_ = 0;
  std::size_t losses_ = 0;
  std::string last_;
};

TEST_F(StorePowerLoss, LosesNothingWhileItServesAndCloses) {
  const auto work = [](StoreSession& session, std::uint64_t /*round*/) {
    for (int life = 0; life < 2; ++life) {
      const auto store = session.open_with_robots();
      session.report(*store, 3, 30);
      session.put_distribution(*store, 100 + static_cast<std::uint64_t>(life));
      session.retire(*store, 0);
      session.report(*store, 1, 10);
    }
  };
  expect_no_loss(3, 15, work);
}

TEST_F(StorePowerLoss, LosesNothingWhileAStoreIsMigrated) {
  const auto work = [](StoreSession& session, std::uint64_t /*round*/) {
    open_migrated(session.file(), test::with_next_schema());
  };
  expect_no_loss(5, 3, work, golden());
}

TEST_F(StorePowerLoss, ABackupIsWholeOrNotThere) {
  const auto work = [](StoreSession& session, std::uint64_t /*round*/) {
    {
      const auto store = session.open_with_robots();
      session.report(*store, 1, 40);
      for (const std::string name : {"copy-1.db", "copy-2.db"}) {
        const auto copied = store->backup(session.file().parent_path() / name, [&](double) {
          session.report(*store, 1, 1);
          return true;
        });
        ASSERT_TRUE(copied && *copied);
        session.ledger().note([&](test::Receipts& noted) { noted.backups.insert(name); });
      }
    }
  };
  expect_no_loss(3, 15, work);
}

/// Old or new, there is one whole store under the name; both have all that was acknowledged.
TEST_F(StorePowerLoss, ARestoreLeavesOneWholeStore) {
  const auto work = [](StoreSession& session, std::uint64_t /*round*/) {
    const std::filesystem::path copy = session.file().parent_path() / "copy-1.db";
    {
      const auto store = session.open_with_robots();
      session.report(*store, 1, 20);
      ASSERT_TRUE(store->backup(copy, [](double) { return true; }));
    }
    session.cut_every(5);
    static_cast<void>(restore_store(copy, session.file(), [](double) {}));
    static_cast<void>(restore_store(copy, session.file(), [](double) {}));
  };
  expect_no_loss(2, 1000, work);
}

/// Linux drops the pages of a failed fsync: what is acknowledged afterwards must not lie behind
/// that hole.
TEST_F(StorePowerLoss, LosesNothingAfterAFailedSync) {
  const auto work = [](StoreSession& session, std::uint64_t round) {
    session.cut_often_after_failures();
    {
      const auto store = session.open_with_robots();
      session.report(*store, 2, 10);
      session.disk().fail({.calls = static_cast<unsigned>(DiskCall::Sync),
                           .first = 3 * round % 12,
                           .count = 1 + round % 3});
      session.report(*store, 2, 30);
    }
    EXPECT_GT(session.disk().failed(), 0U);
  };
  expect_no_loss(6, 25, work);
}

/// Right after a checkpoint the WAL has nothing but the commit that failed. Were the database file
/// written from the page cache before the WAL is durable, a cut would leave parts of that commit.
TEST_F(StorePowerLoss, LeavesNoPartOfACommitWhoseSyncFailed) {
  const auto work = [](StoreSession& session, std::uint64_t round) {
    session.cut_often_after_failures();
    {
      const auto store = session.open_with_robots();
      session.report(*store, 1, 10 + round % 20);
    }
    {
      const auto store = session.open();
      session.disk().fail({.calls = static_cast<unsigned>(DiskCall::Sync), .first = round % 4});
      session.report(*store, 1, 6);
    }
    EXPECT_EQ(session.disk().failed(), 1U);
  };
  expect_no_loss(6, 1000, work);
}

/// The database file has lost pages then, and the WAL is all there is of them.
TEST_F(StorePowerLoss, LosesNothingAfterAFailedCheckpoint) {
  const auto work = [](StoreSession& session, std::uint64_t round) {
    session.cut_often_after_failures();
    {
      const auto store = session.open_with_robots();
      session.disk().fail({.calls = DiskCall::Write | DiskCall::Sync,
                           .first = 7 * round % 60,
                           .count = 1 + round % 3,
                           .name = test::kStoreName});
      session.report(*store, 2, 30);
    }
    EXPECT_GT(session.disk().failed(), 0U);
  };
  expect_no_loss(3, 1000, work);
}

/// As after a failed sync, with a server that was killed after it, or ended: the next one reads the
/// page cache too.
TEST_F(StorePowerLoss, LosesNothingAfterAFailedSyncAndARestart) {
  const auto work = [](StoreSession& session, std::uint64_t /*round*/) {
    session.cut_often_after_failures();
    {
      auto options = StoreSession::small_options();
      options.retry_after = std::chrono::hours(1);
      const auto store = session.open(options);
      session.register_robots(*store);
      session.report(*store, 1, 10);
      session.disk().fail({.calls = static_cast<unsigned>(DiskCall::Sync), .count = 1'000'000});
      EXPECT_EQ(test::report_until_answered(*store, session.ledger(), {100, 101}, 3), 2U);
    }
    session.disk().fail({.count = 0});
    {
      const auto store = session.open();
      session.report(*store, 2, 20);
    }
  };
  expect_no_loss(6, 25, work);
}

// The harness itself: each of these must be found.

TEST_F(StorePowerLoss, TheHarnessFindsADiskThatLies) {
  StoreSession session(kSeed, 15);
  session.disk().lie(true);
  {
    const auto store = session.open_with_robots();
    session.report(*store, 1, 40);
  }
  look_at(session);
  EXPECT_GT(losses_, 0U);
}

/// Every connection opened meanwhile commits without a sync, whatever it asks for.
class WithoutSync {
 public:
  WithoutSync() { sqlite3_auto_extension(reinterpret_cast<void (*)()>(&WithoutSync::relax)); }
  WithoutSync(const WithoutSync&) = delete;
  WithoutSync& operator=(const WithoutSync&) = delete;
  ~WithoutSync() {
    sqlite3_cancel_auto_extension(reinterpret_cast<void (*)()>(&WithoutSync::relax));
  }

 private:
  static int relax(sqlite3* connection, const char** /*message*/, const void* /*routines*/) {
    sqlite3_exec(connection, "PRAGMA synchronous = NORMAL", nullptr, nullptr, nullptr);
    const auto ignore = [](void*, int action, const char* pragma, const char* value, const char*,
                           const char*) {
      const bool is_meant =
          action == SQLITE_PRAGMA && value != nullptr && std::string(pragma) == "synchronous";
      return is_meant ? SQLITE_IGNORE : SQLITE_OK;
    };
    return sqlite3_set_authorizer(connection, ignore, nullptr);
  }
};

TEST_F(StorePowerLoss, TheHarnessFindsACommitWithoutASync) {
  StoreSession session(kSeed, 15);
  {
    const WithoutSync relaxed;
    const auto store = session.open_with_robots();
    session.report(*store, 1, 40);
  }
  look_at(session);
  EXPECT_GT(losses_, 0U);
}

TEST_F(StorePowerLoss, TheHarnessFindsAReceiptBeforeTheCommit) {
  StoreSession session(kSeed, 15);
  {
    const auto store = session.open_with_robots();
    for (std::uint64_t number = 0; number < 60; ++number) {
      session.ledger().note([&](test::Receipts& noted) { noted.reports.insert(number); });
      static_cast<void>(test::report(*store, {test::ledger_attempt(number)}));
    }
  }
  look_at(session);
  EXPECT_GT(losses_, 0U);
}

}  // namespace
}  // namespace kinship::store::store_power_loss_test
