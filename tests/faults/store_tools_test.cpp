// SQLite's own tools at a store, after kinshipd was killed with receipts in the WAL, beside it, and
// while it is down: no receipt is lost, the server starts, copies are good for check and restore.

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "tests/faults/served_store.hpp"

namespace kinship::store_tools_test {
namespace {

namespace fs = std::filesystem;
using test::Answer;
using test::ServedStore;
using test::Stranger;

constexpr std::uint64_t kReports = 20;

class StoreTools : public testing::Test {
 protected:
  void SetUp() override { store_.report(kReports); }

  fs::path copy() const { return store_.beside() / "copy.db"; }

  void expect_good_copy(const fs::path& copy) const {
    const Answer check = ServedStore::offline_of(copy, "check");
    EXPECT_EQ(check.code, 0) << check.out << check.err;
    const fs::path restored = store_.beside() / "restored.db";
    const Answer restore = ServedStore::offline_of(restored, "restore", {copy.string()});
    EXPECT_EQ(restore.code, 0) << restore.err;
    EXPECT_EQ(store_.missing(restored), 0U);
  }
  void expect_all_after_a_start() {
    store_.cell().start();
    expect_all_beside();
  }
  /// Of a running server, which goes on and stops cleanly.
  void expect_all_beside() {
    store_.report(2);
    EXPECT_EQ(store_.cell().status().attempts, kReports + 2);
    EXPECT_EQ(store_.cell().terminate(), 0);
    const Answer check = store_.offline("check");
    EXPECT_EQ(check.code, 0) << check.out << check.err;
    EXPECT_EQ(store_.missing(store_.file()), 0U);
  }
  /// What somebody runs in SQLite's shell, which then ends.
  std::string run(const std::string& sql) const { return Stranger(store_.file()).run(sql); }

  ServedStore store_;
};

TEST_F(StoreTools, ASelectAfterACrashHarmsNothing) {
  store_.cell().kill();
  EXPECT_EQ(run("SELECT count(*) FROM attempt"), std::to_string(kReports));
  EXPECT_FALSE(fs::exists(store_.wal())) << "a shell checkpoints when it ends";
  EXPECT_EQ(store_.offline("check").code, 0);
  expect_all_after_a_start();
}

TEST_F(StoreTools, AWholeCheckpointAfterACrashHarmsNothing) {
  store_.cell().kill();
  run("PRAGMA wal_checkpoint(TRUNCATE)");
  expect_all_after_a_start();
}

TEST_F(StoreTools, RepairAfterASelectLosesNothing) {
  store_.cell().kill();
  run("SELECT count(*) FROM attempt");
  const Answer repaired = store_.offline("repair");
  EXPECT_EQ(repaired.code, 0) << repaired.out << repaired.err;
  EXPECT_TRUE(repaired.says("nothing was lost")) << repaired.out;
  expect_all_after_a_start();
}

TEST_F(StoreTools, CopiesOfARunningStoreAreGood) {
  test::copy_online(store_.file(), copy());
  expect_good_copy(copy());
  const fs::path vacuumed = store_.beside() / "vacuumed.db";
  run("VACUUM INTO '" + vacuumed.string() + "'");
  fs::remove(store_.beside() / "restored.db");
  fs::remove(store_.beside() / "restored.db.lock");
  fs::remove(store_.beside() / "restored.db.high-water-mark");
  expect_good_copy(vacuumed);
  expect_all_beside();
}

TEST_F(StoreTools, CopiesAfterACrashAreGood) {
  store_.cell().kill();
  test::copy_online(store_.file(), copy());
  expect_good_copy(copy());
  expect_all_after_a_start();
}

TEST_F(StoreTools, CheckpointsBesideTheServerHarmNothing) {
  for (const char* const kind : {"PASSIVE", "FULL", "RESTART", "TRUNCATE"}) {
    run(std::string("PRAGMA wal_checkpoint(") + kind + ")");
    store_.report(1);
  }
  store_.cell().kill();
  store_.cell().start();
  store_.report(1);
  EXPECT_EQ(store_.cell().terminate(), 0);
  EXPECT_EQ(store_.missing(store_.file()), 0U);
}

TEST_F(StoreTools, AReaderThatStaysOpenHarmsNothing) {
  auto reader = std::make_unique<Stranger>(store_.file(), SQLITE_OPEN_READONLY);
  reader->run("BEGIN; SELECT count(*) FROM attempt");
  store_.report(5);
  EXPECT_EQ(store_.cell().terminate(), 0);
  store_.cell().start();
  store_.report(5);
  store_.cell().kill();
  reader->run("COMMIT");
  reader.reset();
  store_.cell().start();
  store_.report(1);
  EXPECT_EQ(store_.cell().terminate(), 0);
  EXPECT_EQ(store_.missing(store_.file()), 0U);
}

TEST_F(StoreTools, AWriterOfAnotherProgramIsWaitedForAndNothingIsOpenedAnew) {
  Stranger reader(store_.file());
  reader.run("BEGIN; SELECT count(*) FROM attempt");  // no checkpoint would be whole
  {
    Stranger writer(store_.file());
    writer.run("BEGIN IMMEDIATE");
    EXPECT_FALSE(store_.offer()) << "written beside the lock of another writer";
    EXPECT_TRUE(store_.status_becomes([](const ServerStatus& status) {
      return !status.writable &&
             status.storage_message.find("another program writes") != std::string::npos;
    }));
    writer.run("ROLLBACK");
  }
  EXPECT_TRUE(store_.has_all_receipts()) << "while the reader is still there";
  EXPECT_TRUE(store_.cell().status().writable);
  reader.run("COMMIT");
  EXPECT_EQ(store_.cell().terminate(), 0);
  EXPECT_EQ(store_.missing(store_.file()), 0U);
}

TEST_F(StoreTools, MaintenanceByAStrangerWhileItIsDownHarmsNothing) {
  for (const char* const sql : {"PRAGMA journal_mode = DELETE", "VACUUM", "ANALYZE", "REINDEX",
                                "PRAGMA optimize", "CREATE TABLE noted (x)"}) {
    SCOPED_TRACE(sql);
    EXPECT_EQ(store_.cell().terminate(), 0);
    run(sql);
    const Answer check = store_.offline("check");
    EXPECT_EQ(check.code, 0) << check.out << check.err;
    store_.cell().start();
    store_.report(1);
  }
  EXPECT_EQ(store_.cell().status().storage_message.find("rolled back"), std::string::npos);
  EXPECT_EQ(store_.cell().terminate(), 0);
  EXPECT_EQ(store_.offline("repair").code, 0);
  EXPECT_EQ(store_.missing(store_.file()), 0U);
}

/// The steps of Litestream (db.go of version 0.3): its own tables in the file, a read transaction
/// that keeps others from resetting the WAL, frames copied from the WAL's file, and checkpoints of
/// its own, before which it keeps others from writing.
class Litestream {
 public:
  explicit Litestream(const fs::path& file) : file_(file), database_(file), reader_(file) {
    database_.run(
        "PRAGMA wal_autocheckpoint = 0;"
        "CREATE TABLE IF NOT EXISTS _litestream_seq (id INTEGER PRIMARY KEY, seq INTEGER);"
        "CREATE TABLE IF NOT EXISTS _litestream_lock (id INTEGER)");
    begin_generation();
    fs::copy_file(file_, replica());
  }

  fs::path replica() const { return file_.string() + ".replica"; }

  /// \param kind  of SQLite's checkpoints.
  void sync(const std::string& kind) {
    copy_frames();
    database_.run("BEGIN; INSERT INTO _litestream_lock (id) VALUES (1)");
    copy_frames();  // nobody writes now
    database_.run("ROLLBACK");
    reader_.run("COMMIT");
    database_.run("PRAGMA wal_checkpoint(" + kind + ")");
    begin_generation();
  }

 private:
  void begin_generation() {
    database_.run(
        "INSERT INTO _litestream_seq (id, seq) VALUES (1, 1) "
        "ON CONFLICT (id) DO UPDATE SET seq = seq + 1");
    reader_.run("BEGIN; SELECT count(*) FROM _litestream_seq");
  }
  void copy_frames() const {
    fs::copy_file(file_.string() + "-wal", replica().string() + "-wal",
                  fs::copy_options::overwrite_existing);
  }

  fs::path file_;
  Stranger database_, reader_;
};

TEST_F(StoreTools, LitestreamBesideItHarmsNothing) {
  store_.cell().terminate();  // so that all is in the file that it copies
  store_.cell().start();
  {
    Litestream litestream(store_.file());
    for (const char* const kind : {"PASSIVE", "RESTART", "TRUNCATE", "PASSIVE"}) {
      store_.report(5);
      litestream.sync(kind);
    }
    store_.cell().kill();
    store_.cell().start();  // beside it
    store_.report(1);
    litestream.sync("PASSIVE");
    EXPECT_TRUE(store_.cell().status().writable);
  }
  EXPECT_EQ(store_.cell().terminate(), 0);
  const Answer check = store_.offline("check");
  EXPECT_EQ(check.code, 0) << check.out << check.err;
  EXPECT_EQ(store_.missing(store_.file()), 0U);
  const Answer repair = store_.offline("repair");
  EXPECT_EQ(repair.code, 0) << repair.out << repair.err;
  EXPECT_EQ(store_.missing(store_.file()), 0U) << "its tables are no reason to lose a row";
}

TEST_F(StoreTools, WhatLitestreamCopiesIsAStoreForARestore) {
  EXPECT_EQ(store_.cell().terminate(), 0);
  store_.cell().start();
  {
    Litestream litestream(store_.file());
    store_.report(5);
    litestream.sync("PASSIVE");  // its replica is the file, and the frames until then
    store_.cell().kill();
    expect_good_copy(litestream.replica());
  }
}

}  // namespace
}  // namespace kinship::store_tools_test
