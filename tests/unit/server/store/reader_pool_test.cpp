#include "server/store/sqlite/opening/reader_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"
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

TEST_F(ReaderPoolTest, ASuspensionThatGoesOnIsAFailureAndNoWaitForEver) {
  pool_.suspend();
  const auto start = std::chrono::steady_clock::now();
  try {
    pool_.lease();
    FAIL() << "lent while suspended";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  pool_.resume();
  EXPECT_EQ(pool_.lease()->integer("SELECT count(*) FROM t"), 0);
}

TEST_F(ReaderPoolTest, TellsHowLongTheLongestReadingGoesOn) {
  EXPECT_FALSE(pool_.longest_reading());
  const auto start = std::chrono::steady_clock::now();
  {
    const auto first = std::make_unique<ReaderPool::Lease>(pool_);
    const auto lent = std::chrono::steady_clock::now();
    const ReaderPool::Lease second = pool_.lease();
    ASSERT_TRUE(pool_.longest_reading());
    const auto now = std::chrono::steady_clock::now();
    EXPECT_GE(*pool_.longest_reading(), now - lent);
    EXPECT_LE(*pool_.longest_reading(), std::chrono::steady_clock::now() - start);
  }
  EXPECT_FALSE(pool_.longest_reading());
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
