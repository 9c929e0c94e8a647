#include <fstream>

#include "server/store/maintenance.hpp"
#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

constexpr auto kGoOn = [](double) { return true; };

/// The directory of a copy, in which the engine finds it by its usual name.
std::filesystem::path copy_in(const test::TemporaryDirectory& directory) {
  return directory / "store.db";
}

std::size_t files_in(const test::TemporaryDirectory& directory) {
  const std::filesystem::directory_iterator files(directory.path());
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

constexpr std::uint64_t kManyPaths = 2000;

/// 10 MB, which no engine copies at once.
void report_many(Store& store, const Digest& robot) {
  constexpr std::uint64_t kBatch = 200;
  for (std::uint64_t first = 0; first < kManyPaths; first += kBatch) {
    std::vector<Attempt> attempts;
    for (std::uint64_t number = first; number < first + kBatch; ++number) {
      attempts.push_back(test::make_attempt(robot, "shelf", number));
      attempts.back().path = test::make_path(number, test::kDof, 200);
    }
    test::report(store, std::move(attempts));
  }
}

TEST_P(StoreBackup, ABackupIsAStoreWithAllThatWasThere) {
  test::report(*store_, {solved(1), solved(2), test::make_unsolved(iiwa_.digest, "table", 3)});
  const Distribution distribution = test::make_distribution(iiwa_.digest, "shelf", 3);
  store_->put_distribution(distribution);
  const test::TemporaryDirectory elsewhere;
  double last = 0;
  const Result<bool> done = store_->backup(copy_in(elsewhere), [&](double progress) {
    EXPECT_GE(progress, last);
    last = progress;
    return progress <= 1;
  });
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_TRUE(*done);
  EXPECT_EQ(last, 1);
  EXPECT_EQ(files_in(elsewhere), 1U);
  const StoreCheck check = check_store(copy_in(elsewhere), [](double) {});
  EXPECT_EQ(check.problems, 0U) << check.messages.front();
  EXPECT_NE(check.epoch, Uuid{});
  report(solved(4));  // not in the copy
  const std::unique_ptr<Store> copy = GetParam().open(elsewhere.path(), {});
  EXPECT_EQ(copy->status().paths, 2U);
  EXPECT_EQ(copy->status().attempts, 3U);
  EXPECT_EQ(copy->robots().size(), 2U);
  EXPECT_TRUE(copy->find_distribution(distribution.id));
  EXPECT_EQ(test::report(*copy, {solved(1)})[0].status, ReceiptStatus::Duplicate);
}

TEST_P(StoreBackup, AFileThatAppearsDuringABackupStays) {
  const test::TemporaryDirectory elsewhere;
  const Result<bool> refused = store_->backup(copy_in(elsewhere), [&](double progress) {
    if (progress == 1)
      std::ofstream(copy_in(elsewhere)) << "mine";
    return true;
  });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::Conflict);
  EXPECT_EQ(std::filesystem::file_size(copy_in(elsewhere)), 4U);
  EXPECT_EQ(files_in(elsewhere), 1U);
}

TEST_P(StoreBackup, ABackupThatIsEndedLeavesNothing) {
  report(solved(1));
  const test::TemporaryDirectory elsewhere;
  const Result<bool> ended = store_->backup(copy_in(elsewhere), [](double) { return false; });
  ASSERT_TRUE(ended);
  EXPECT_FALSE(*ended);
  EXPECT_EQ(files_in(elsewhere), 0U);
  EXPECT_THROW(store_->backup(copy_in(elsewhere),
                              [](double) -> bool { throw std::runtime_error("of the caller"); }),
               std::runtime_error);
  EXPECT_EQ(files_in(elsewhere), 0U);
  EXPECT_TRUE(*store_->backup(copy_in(elsewhere), kGoOn));
}

TEST_P(StoreBackup, ABackupThatCannotBeMadeNamesTheFile) {
  const std::filesystem::path nowhere = directory_ / "no such directory" / "copy.db";
  try {
    static_cast<void>(store_->backup(nowhere, kGoOn));
    FAIL() << "a backup in no directory";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(failure.what()).find(nowhere.string()), std::string::npos);
  }
  EXPECT_EQ(report(solved(1)), ReceiptStatus::Stored);
}

TEST_P(StoreBackup, OnlyOneBackupIsMadeAtATime) {
  report_many(*store_, panda_.digest);
  const test::TemporaryDirectory elsewhere;
  int tried = 0;
  EXPECT_TRUE(*store_->backup(copy_in(elsewhere), [&](double progress) {
    if (progress == 1)
      return true;  // the copying is over
    ++tried;
    const Result<bool> second = store_->backup(elsewhere / "second.db", kGoOn);
    EXPECT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::Unavailable);
    return true;
  }));
  EXPECT_GT(tried, 0);
  EXPECT_EQ(files_in(elsewhere), 1U);
}

TEST_P(StoreBackup, ReportsGoOnDuringABackupThatIsOfOneInstant) {
  report_many(*store_, panda_.digest);
  constexpr std::uint64_t kFirst = 1'000'000;
  std::uint64_t number = kFirst;
  std::uint64_t acknowledged_at_end = 0;
  const test::TemporaryDirectory elsewhere;
  // A pair of paths in each batch: a copy of one instant has both or none.
  ASSERT_TRUE(*store_->backup(copy_in(elsewhere), [&](double progress) {
    if (progress == 1)
      acknowledged_at_end = number - kFirst;
    EXPECT_EQ(test::statuses(test::report(*store_, {solved(number), solved(number + 1)})),
              std::vector<ReceiptStatus>(2, ReceiptStatus::Stored));
    number += 2;
    return true;
  }));
  EXPECT_GT(acknowledged_at_end, 0U);  // it was in steps
  const std::unique_ptr<Store> copy = GetParam().open(elsewhere.path(), {});
  const bool has_all = GetParam().backup_instant == Engine::BackupInstant::End;
  const std::uint64_t paths = kManyPaths + (has_all ? acknowledged_at_end : 0);
  EXPECT_EQ(copy->status().paths, paths);
  EXPECT_EQ(copy->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 10'000}).size(),
            paths);
  EXPECT_EQ(store_->status().paths, kManyPaths + number - kFirst);
}

}  // namespace
}  // namespace kinship::store
