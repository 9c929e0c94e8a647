#include <gtest/gtest.h>

#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/opening/connection.hpp"
#include "tests/faults/store_session.hpp"

/// A disk without room, a database file that cannot be synced, a WAL that a reading pins.
namespace kinship::store::store_room_test {
namespace {

using test::DiskCall;
using test::StoreSession;

constexpr std::uint64_t kSeed = 20261123;
constexpr std::uint64_t kMega = std::uint64_t{1} << 20U;
constexpr std::uint64_t kPlenty = 100 * kMega;

class StoreRoom : public testing::Test {
 protected:
  void open(const SqliteOptions& options) {
    session_.disk().set_capacity(kPlenty);
    store_ = session_.open(options);
    session_.register_robots(*store_);
    session_.report(*store_, 1, 5);
  }
  /// A capacity that leaves so many bytes free.
  void leave_free(std::uint64_t bytes) {
    session_.disk().set_capacity(session_.disk().used() + bytes);
  }
  Receipt report(std::uint64_t number) {
    Receipt receipt = test::report(*store_, {test::ledger_attempt(number)}).at(0);
    if (receipt.status == ReceiptStatus::Stored || receipt.status == ReceiptStatus::Recorded)
      session_.ledger().note([&](test::Receipts& noted) { noted.reports.insert(number); });
    return receipt;
  }
  /// \return the first report that is not taken; `kLast` if all are.
  std::uint64_t report_until_refused() {
    std::uint64_t number = kFirst;
    while (number < kLast && report(number).status != ReceiptStatus::TryAgain)
      ++number;
    return number;
  }
  std::uint64_t wal_size() const {
    return std::filesystem::file_size(session_.file().string() + "-wal");
  }
  bool has_ballast() const {
    return std::filesystem::exists(session_.file().string() + ".ballast");
  }
  std::string loss() { return test::find_loss(*store_, session_.ledger().receipts()); }

  static constexpr std::uint64_t kFirst = 100;
  static constexpr std::uint64_t kLast = 1000;
  StoreSession session_{kSeed, 1000};
  std::unique_ptr<Store> store_;
};

TEST_F(StoreRoom, BelowTheWatermarkReportsWaitAndAreTakenOnceThereIsRoom) {
  SqliteOptions options = StoreSession::small_options();
  options.free_space_watermark_bytes = 2 * kMega;
  open(options);
  EXPECT_TRUE(store_->status().writable);
  test::begin_task(*store_, test::ledger_robots()[0].digest, "stack");
  leave_free(kMega + 5);

  const Receipt refused = report(kFirst);
  EXPECT_EQ(refused.status, ReceiptStatus::TryAgain);
  for (const char* const part : {"the file system at '/", "(1048581 bytes) free", "2 MB"})
    EXPECT_NE(refused.message.find(part), std::string::npos) << refused.message;
  const StoreStatus status = store_->status();
  EXPECT_FALSE(status.writable);
  EXPECT_NE(status.message.find(refused.message), std::string::npos) << status.message;
  store_->put_distribution(test::make_distribution(test::ledger_robots()[0].digest, "stack", 1));

  session_.disk().set_capacity(kPlenty);
  EXPECT_EQ(report(kFirst).status, ReceiptStatus::Stored);
  EXPECT_TRUE(store_->status().writable);
  EXPECT_EQ(loss(), "");
}

TEST_F(StoreRoom, OnAFullDiskTheBallastIsRoomToGoOn) {
  SqliteOptions options = StoreSession::small_options();
  options.ballast_bytes = 2 * kMega;
  open(options);
  ASSERT_TRUE(has_ballast());
  leave_free(0);

  // Sooner or later the WAL, or the file in a checkpoint, has no room to grow.
  for (std::uint64_t number = kFirst; has_ballast(); ++number) {
    ASSERT_LT(number, kLast);
    EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {number}), 0U);
  }
  session_.retire(*store_, 0);
  EXPECT_NE(store_->status().message.find("ballast of 2 MB"), std::string::npos);

  session_.disk().set_capacity(kPlenty);
  EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {kLast, kLast + 1}), 0U);
  EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {kLast + 2}), 0U);
  EXPECT_TRUE(has_ballast());
  EXPECT_EQ(store_->status().message.find("ballast"), std::string::npos);
  EXPECT_EQ(loss(), "");
}

TEST_F(StoreRoom, WithoutABallastAFullDiskStaysFull) {
  open(StoreSession::small_options());
  leave_free(0);
  std::uint64_t refused = report_until_refused();
  // What a checkpoint frees is room for a few more, a few times.
  constexpr int kTimes = 50;
  for (int i = 0;
       i < kTimes && test::report_until_answered(*store_, session_.ledger(), {refused}, 100) == 0;
       ++i)
    refused = report_until_refused();
  ASSERT_LT(refused, kLast);
  EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {refused}, 100), 1U);
  EXPECT_FALSE(store_->status().writable);
  session_.disk().set_capacity(kPlenty);
  EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {refused}), 0U);
  EXPECT_EQ(loss(), "");
}

TEST_F(StoreRoom, ACheckpointThatFailsIsSeenAndEndsTheGrowthOfTheWal) {
  open(StoreSession::small_options());
  session_.disk().fail({.calls = static_cast<unsigned>(DiskCall::Sync),
                        .count = UINT64_MAX,
                        .name = test::kStoreName});
  const std::uint64_t refused = report_until_refused();
  ASSERT_LT(refused, kLast);
  const StoreStatus status = store_->status();
  EXPECT_FALSE(status.writable);
  EXPECT_NE(status.message.find("checkpoint"), std::string::npos) << status.message;
  EXPECT_NE(status.message.find("failures of the disk"), std::string::npos) << status.message;
  EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {refused}, 100), 1U);
  EXPECT_LT(wal_size(), 2 * kMega);

  session_.disk().fail({.count = 0});
  EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {refused}), 0U);
  EXPECT_TRUE(store_->status().writable);
  EXPECT_EQ(loss(), "");
  store_.reset();
  EXPECT_EQ(session_.find_losses(), std::vector<std::string>());
}

TEST_F(StoreRoom, AReadingThatGoesOnDoesNotGrowTheWalForEver) {
  SqliteOptions options = StoreSession::small_options();
  options.max_wal_bytes = 2 * kMega;
  open(options);
  {
    const std::unique_ptr<Database> other = open_reader(session_.file());
    const Transaction snapshot(*other, Transaction::Kind::Read);
    EXPECT_GT(other->integer("SELECT count(*) FROM attempt"), 0);

    ASSERT_LT(report_until_refused(), kLast);
    const Receipt refused = report(kLast);
    EXPECT_NE(refused.message.find("the WAL holds 2 MB, of 2 MB at most"), std::string::npos)
        << refused.message;
    EXPECT_NE(store_->status().message.find("another program reads the store"), std::string::npos);
    EXPECT_FALSE(store_->status().writable);
    EXPECT_LT(wal_size(), 3 * kMega);
  }
  EXPECT_EQ(test::report_until_answered(*store_, session_.ledger(), {kLast}), 0U);
  EXPECT_TRUE(store_->status().writable);
  EXPECT_EQ(loss(), "");
}

}  // namespace
}  // namespace kinship::store::store_room_test
