#include <gtest/gtest.h>

#include <chrono>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// A disk that stops taking writes and takes them again later.
namespace kinship::store::store_disk_test {
namespace {

// Room for the shared-memory file of SQLite, none for another frame of the WAL.
constexpr rlim_t kNoRoom = 40'000;

class StoreDisk : public testing::Test {
 protected:
  StoreDisk() {
    static_cast<void>(store_->register_robot(robot_));
    for (std::uint64_t i = 0; i < kBefore; ++i)
      report(i);
  }

  Receipt report(std::uint64_t number) {
    Attempt attempt = test::make_attempt(robot_.digest, "shelf", number);
    attempt.path = test::make_path(number, test::kDof, 300);
    return test::report(*store_, {attempt}).at(0);
  }

  /// As a client does: again until it is not TryAgain. Tries to reopen are 1 ms apart.
  Receipt report_until_answered(std::uint64_t number) {
    Receipt receipt = report(number);
    for (int again = 0; again < 100'000 && receipt.status == ReceiptStatus::TryAgain; ++again)
      receipt = report(number);
    return receipt;
  }

  static constexpr std::uint64_t kBefore = 50;

  const test::TemporaryDirectory directory_;
  const RobotRecord robot_ = test::make_robot("panda", 1);
  const std::unique_ptr<Store> store_ =
      open_sqlite_store(directory_ / "s.db", {.retry_after = std::chrono::milliseconds(1)});
};

TEST_F(StoreDisk, AnswersTryAgainWhileItCannotWriteAndStoresAfterwards) {
  Receipt during;
  StoreStatus status;
  std::size_t readable = 0;
  {
    const test::FullDisk full(kNoRoom);
    during = report(1000);
    status = store_->status();
    readable = store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 1000}).size();
  }
  EXPECT_EQ(during.status, ReceiptStatus::TryAgain);
  EXPECT_FALSE(during.message.empty());
  EXPECT_FALSE(status.writable);
  EXPECT_NE(status.message.find("not writable"), std::string::npos) << status.message;
  EXPECT_EQ(readable, kBefore);

  EXPECT_EQ(report_until_answered(1000).status, ReceiptStatus::Stored);
  EXPECT_TRUE(store_->status().writable);
  EXPECT_EQ(store_->status().paths, kBefore + 1);
  EXPECT_EQ(report(0).status, ReceiptStatus::Duplicate);  // what was acknowledged before is there
}

TEST_F(StoreDisk, WhoWaitsForAResultIsToldOfTheFailure) {
  std::string said;
  {
    const test::FullDisk full(kNoRoom);
    try {
      store_->put_distribution(test::make_distribution(robot_.digest, "shelf", 1));
    } catch (const Failure& failure) {
      said = failure.code() == ErrorCode::Storage ? failure.what() : "another failure";
    }
  }
  EXPECT_NE(said.find("SQLite"), std::string::npos) << said;
  ASSERT_EQ(report_until_answered(1000).status, ReceiptStatus::Stored);
  EXPECT_EQ(store_->put_distribution(test::make_distribution(robot_.digest, "shelf", 1)), 1U);
}

TEST_F(StoreDisk, SurvivesARowOfFailures) {
  for (std::uint64_t round = 0; round < 5; ++round) {
    ReceiptStatus during{};
    {
      const test::FullDisk full(kNoRoom);
      during = report(1000 + round).status;
    }
    EXPECT_EQ(during, ReceiptStatus::TryAgain);
    EXPECT_EQ(report_until_answered(1000 + round).status, ReceiptStatus::Stored);
  }
  EXPECT_EQ(store_->status().paths, kBefore + 5);
  EXPECT_EQ(store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 1000}).size(),
            kBefore + 5);
}

/// KINSHIP_LONG=1: 4 GB.
TEST(StoreDiskOfALargeStore, GoesOnWithinASecondOnceTheDiskDoes) {
  const std::uint64_t bytes = (test::is_long_run() ? std::uint64_t{4} << 10U : 20) << 20U;
  constexpr Eigen::Index kWaypoints = 16'384;
  constexpr std::uint64_t kBytesOfAPath = kWaypoints * test::kDof * sizeof(double);
  constexpr std::uint64_t kAtOnce = 8;
  const test::TemporaryDirectory directory;
  const RobotRecord robot = test::make_robot("panda", 1);
  const std::unique_ptr<Store> store =
      open_sqlite_store(directory / "s.db", {.retry_after = std::chrono::milliseconds(1)});
  ASSERT_TRUE(store->register_robot(robot));
  for (std::uint64_t number = 0; number * kBytesOfAPath < bytes; number += kAtOnce) {
    std::vector<Attempt> attempts;
    for (std::uint64_t i = number; i < number + kAtOnce; ++i) {
      attempts.push_back(test::make_attempt(robot.digest, "shelf", i));
      attempts.back().path = test::make_path(i, test::kDof, kWaypoints);
    }
    for (const Receipt& receipt : test::report(*store, std::move(attempts)))
      ASSERT_EQ(receipt.status, ReceiptStatus::Stored) << receipt.message;
  }
  ASSERT_GE(std::filesystem::file_size(directory / "s.db") +
                std::filesystem::file_size(directory / "s.db-wal"),
            bytes / 10 * 9);  // stored waypoints are a little smaller

  const Attempt next = test::make_attempt(robot.digest, "shelf", 1'000'000);
  ReceiptStatus status{};
  {
    const test::FullDisk full(kNoRoom);
    status = test::report(*store, {next}).at(0).status;
  }
  EXPECT_EQ(status, ReceiptStatus::TryAgain);
  const auto start = std::chrono::steady_clock::now();
  while (status == ReceiptStatus::TryAgain)
    status = test::report(*store, {next}).at(0).status;
  EXPECT_EQ(status, ReceiptStatus::Stored);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_LT(took.count(), 1.0);
  RecordProperty("seconds", std::to_string(took.count()));
}

TEST(StoreBackupDisk, ABackupThatFindsNoRoomLeavesNothingAndTheStoreGoesOn) {
  const test::TemporaryDirectory directory;
  const RobotRecord robot = test::make_robot("panda", 1);
  const auto attempt = [&](std::uint64_t number) {
    Attempt made = test::make_attempt(robot.digest, "shelf", number);
    made.path = test::make_path(number, test::kDof, 300);
    return made;
  };
  const auto go_on = [](double) { return true; };
  {
    const std::unique_ptr<Store> store = open_sqlite_store(directory / "s.db");
    ASSERT_TRUE(store->register_robot(robot));
    std::vector<Attempt> attempts;
    for (std::uint64_t number = 0; number < 400; ++number)
      attempts.push_back(attempt(number));
    test::report(*store, std::move(attempts));
  }
  ASSERT_GT(std::filesystem::file_size(directory / "s.db"), 2'000'000U);
  const std::unique_ptr<Store> store = open_sqlite_store(directory / "s.db");  // an empty WAL
  const std::filesystem::path copy = directory / "copy.db";
  std::string said;
  ReceiptStatus during{};
  {
    const test::FullDisk full(1'000'000);  // less than the copy, more than a WAL of few reports
    try {
      static_cast<void>(store->backup(copy, go_on));
    } catch (const Failure& failure) {
      said = failure.what();
    }
    during = test::report(*store, {attempt(1000)}).at(0).status;
  }
  EXPECT_NE(said.find(copy.string()), std::string::npos) << said;
  EXPECT_EQ(during, ReceiptStatus::Stored);
  EXPECT_TRUE(store->status().writable);
  EXPECT_FALSE(std::filesystem::exists(copy));
  EXPECT_FALSE(std::filesystem::exists(copy.string() + ".part"));
  EXPECT_TRUE(*store->backup(copy, go_on));
  EXPECT_EQ(open_sqlite_store(copy)->status().paths, 401U);
}

}  // namespace
}  // namespace kinship::store::store_disk_test
