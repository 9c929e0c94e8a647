// Copies and rollbacks of a store's file, and who notices them.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::history_test {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// As `cp` over a file that is there: the same inode with other contents.
void overwrite(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

class HistoryTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(home_);
    open();
    ASSERT_TRUE(store_->register_robot(robot_));
  }
  void open(const fs::path& file) {
    store_.reset();
    store_ = open_sqlite_store(file);
  }
  void open() { open(file_); }
  void report(std::uint64_t first, std::uint64_t count = 1) {
    for (std::uint64_t number = first; number < first + count; ++number)
      test::report(*store_, {test::make_attempt(robot_.digest, "shelf", number)});
  }
  /// All there is of the closed store but its high-water mark.
  std::string snapshot() {
    store_.reset();
    EXPECT_FALSE(fs::exists(file_.string() + "-wal"));
    return bytes_of(file_);
  }
  /// Puts a snapshot back as a rollback of the machine would, and the high-water mark with it.
  void roll_back(const std::string& bytes, const std::string& mark) {
    store_.reset();
    overwrite(file_, bytes);
    overwrite(high_water_mark_, mark);
  }

  test::TemporaryDirectory directory_;
  const fs::path home_ = directory_ / "home";
  const fs::path file_ = home_ / "store.db";
  const fs::path high_water_mark_ = home_ / "store.db.high-water-mark";
  const RobotRecord robot_ = test::make_robot("panda", 1);
  std::unique_ptr<Store> store_;
};

TEST_F(HistoryTest, AStoreOpenedAgainKeepsItsEpochAndWhatWasMarked) {
  const Uuid epoch = store_->epoch();
  for (std::uint64_t i = 0; i < 5; ++i) {
    report(10 * i, i);  // of the first run nothing
    const ConsistencyToken token = store_->point().token;
    EXPECT_FALSE(store_->has_lost(token));
    open();
    EXPECT_EQ(store_->epoch(), epoch);
    EXPECT_FALSE(store_->has_lost(token)) << i;
    EXPECT_EQ(store_->status().rollbacks, 0U);
    EXPECT_EQ(store_->status().message.find("rolled back"), std::string::npos);
  }
}

TEST_F(HistoryTest, AServedCopyBeginsAnEpochAndTheOriginalDoesNot) {
  report(1, 3);
  const Uuid epoch = store_->epoch();
  const fs::path copy = directory_ / "copy.db";
  overwrite(copy, snapshot());
  open(copy);
  EXPECT_NE(store_->epoch(), epoch);
  EXPECT_EQ(store_->status().rollbacks, 1U);
  EXPECT_NE(store_->status().message.find("is a copy"), std::string::npos)
      << store_->status().message;
  const Uuid of_copy = store_->epoch();
  open(copy);  // once
  EXPECT_EQ(store_->epoch(), of_copy);
  open();
  EXPECT_EQ(store_->epoch(), epoch);
}

TEST_F(HistoryTest, AnOnlineBackupThatIsServedBeginsAnEpoch) {
  report(1, 3);
  const fs::path copy = directory_ / "copy.db";
  ASSERT_TRUE(store_->backup(copy, [](double) { return true; }));
  const Uuid epoch = store_->epoch();
  open(copy);
  EXPECT_NE(store_->epoch(), epoch);
}

TEST_F(HistoryTest, OpeningAndReportingNothingLeavesTheFileAsItIs) {
  report(1, 3);
  const std::string before = snapshot();
  open();
  const ConsistencyToken token = store_->point().token;
  EXPECT_EQ(snapshot(), before);
  open();
  EXPECT_FALSE(store_->has_lost(token));
}

TEST_F(HistoryTest, TheFirstRunOfAStoreIsKnownBeforeItHasWrittenAnything) {
  const ConsistencyToken token = store_->point().token;
  open();
  report(1);
  open();
  EXPECT_FALSE(store_->has_lost(token));
}

TEST_F(HistoryTest, ARenamedStoreKeepsItsEpoch) {
  report(1);
  const Uuid epoch = store_->epoch();
  store_.reset();
  const fs::path moved = directory_ / "moved";
  fs::rename(home_, moved);
  open(moved / "store.db");
  EXPECT_EQ(store_->epoch(), epoch);
}

TEST_F(HistoryTest, ADirectoryPutBackFromACopyIsAnotherFile) {
  report(1, 3);
  store_.reset();
  fs::copy(home_, directory_ / "aside", fs::copy_options::recursive);
  open();
  report(10);
  const Uuid epoch = store_->epoch();
  store_.reset();
  fs::remove_all(home_);
  fs::copy(directory_ / "aside", home_, fs::copy_options::recursive);
  open();
  EXPECT_NE(store_->epoch(), epoch);
}

/// The file, its inode and its high-water mark put back: only who has a later mark can tell.
class HistoryOfClients : public HistoryTest {
 protected:
  void SetUp() override {
    HistoryTest::SetUp();
    report(1, 3);
    early_ = store_->point().token;
    before_ = snapshot();
    mark_before_ = bytes_of(high_water_mark_);
    open();
    report(10, 3);
    late_ = store_->point().token;
    epoch_ = store_->epoch();
    roll_back(before_, mark_before_);
    open();
  }

  ConsistencyToken early_, late_;
  std::string before_, mark_before_;
  Uuid epoch_;
};

TEST_F(HistoryOfClients, ALaterMarkIsLostAndBeginsOneEpoch) {
  ASSERT_EQ(store_->epoch(), epoch_);
  EXPECT_FALSE(store_->has_lost(early_));
  EXPECT_FALSE(store_->begin_epoch_if_lost(early_));
  ASSERT_TRUE(store_->has_lost(late_));
  EXPECT_TRUE(store_->begin_epoch_if_lost(late_));
  const Uuid next = store_->epoch();
  EXPECT_NE(next, epoch_);
  EXPECT_FALSE(store_->has_lost(late_));  // of an epoch that is over
  EXPECT_FALSE(store_->begin_epoch_if_lost(late_));
  EXPECT_EQ(store_->status().rollbacks, 1U);
  report(20);
  const ConsistencyToken newest = store_->point().token;
  open();
  EXPECT_EQ(store_->epoch(), next);
  EXPECT_EQ(store_->point().token, newest);
  EXPECT_FALSE(store_->has_lost(newest));
}

TEST_F(HistoryOfClients, AMarkThatTheStoreNeverMadeChangesNothing) {
  for (std::size_t i = 0; i < late_.size(); ++i) {
    ConsistencyToken forged = late_;
    forged[i] ^= 0x40;
    EXPECT_FALSE(store_->has_lost(forged)) << i;
    EXPECT_FALSE(store_->begin_epoch_if_lost(forged)) << i;
  }
  EXPECT_EQ(store_->epoch(), epoch_);
}

TEST_F(HistoryTest, ADamagedHighWaterMarkIsNone) {
  report(1, 3);
  const Uuid epoch = store_->epoch();
  for (const std::string& text : {std::string(), std::string("x"), std::string(300, '0')}) {
    store_.reset();
    overwrite(high_water_mark_, text);
    open();
    EXPECT_EQ(store_->epoch(), epoch);
  }
  store_.reset();
  std::string text = bytes_of(high_water_mark_);
  text[75] = '9';  // a digit of the position
  overwrite(high_water_mark_, text);
  open();
  EXPECT_EQ(store_->epoch(), epoch);
}

}  // namespace
}  // namespace kinship::store::history_test
