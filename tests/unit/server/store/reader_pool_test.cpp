#include "server/store/sqlite/reader_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "server/store/sqlite/sqlite_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::reader_pool_test {
namespace {

class ReaderPoolTest : public testing::Test {
 protected:
  ReaderPoolTest() { writer_.execute("PRAGMA journal_mode = WAL; CREATE TABLE t (x INTEGER)"); }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "r.db";
  Database writer_{file_, Access::Create};
  ReaderPool pool_{file_};
};

TEST_F(ReaderPoolTest, ALeaseSeesOneSnapshotAndTheNextOneTheNewest) {
  {
    const ReaderPool::Lease lease = pool_.lease();
    EXPECT_EQ(lease->integer("SELECT count(*) FROM t"), 0);
    writer_.execute("INSERT INTO t VALUES (1)");
    EXPECT_EQ(lease->integer("SELECT count(*) FROM t"), 0);
  }
  EXPECT_EQ(pool_.lease()->integer("SELECT count(*) FROM t"), 1);
}

TEST_F(ReaderPoolTest, ALeaseCannotWriteOrCheckpoint) {
  const ReaderPool::Lease lease = pool_.lease();
  EXPECT_THROW(lease->execute("INSERT INTO t VALUES (1)"), SqliteError);
  EXPECT_EQ(lease->integer("PRAGMA wal_autocheckpoint"), 0);
}

TEST_F(ReaderPoolTest, SuspendWaitsForTheLeasesAndHoldsTheNextOnesBack) {
  std::promise<void> lent;
  std::promise<void> give_back;
  std::thread reader([&] {
    const ReaderPool::Lease lease = pool_.lease();
    lent.set_value();
    give_back.get_future().wait();
  });
  lent.get_future().wait();
  std::future<void> suspended = std::async(std::launch::async, [&] { pool_.suspend(); });
  EXPECT_EQ(suspended.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout);
  give_back.set_value();
  suspended.get();
  reader.join();
  writer_.execute("PRAGMA journal_mode = DELETE");  // works only when nobody has the file open

  std::future<std::int64_t> next = std::async(
      std::launch::async, [&] { return pool_.lease()->integer("SELECT count(*) FROM t"); });
  EXPECT_EQ(next.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout);
  pool_.resume();
  EXPECT_EQ(next.get(), 0);
}

TEST_F(ReaderPoolTest, MoreThreadsThanConnectionsTakeTurns) {
  std::vector<std::thread> threads;
  std::atomic<int> read = 0;
  for (int i = 0; i < 16; ++i)
    threads.emplace_back([&] {
      for (int k = 0; k < 20; ++k)
        if (pool_.lease()->integer("SELECT count(*) + 1 FROM t") == 1)
          ++read;
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(read, 16 * 20);
}

TEST_F(ReaderPoolTest, AFailedOpeningIsNotLentForGood) {
  ReaderPool missing(directory_ / "missing.db");
  for (int i = 0; i < 10; ++i)
    EXPECT_THROW(missing.lease(), SqliteError);  // more than it lends
}

}  // namespace
}  // namespace kinship::store::reader_pool_test
