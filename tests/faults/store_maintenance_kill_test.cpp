#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/faults/kill_point.hpp"
#include "tests/support/next_schema.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

/// kill -9 before every single change that a verb makes to the file system.
namespace kinship::store::store_maintenance_kill_test {
namespace {

namespace fs = std::filesystem;

void ignore(double) {}

const RobotRecord& robot() {
  static const RobotRecord kRobot = test::make_robot("panda", 1);
  return kRobot;
}

void add_attempts(const fs::path& file, std::uint64_t first, std::uint64_t count) {
  const std::unique_ptr<Store> store = open_sqlite_store(file);
  static_cast<void>(store->register_robot(robot()));
  std::vector<Attempt> attempts;
  for (std::uint64_t number = first; number < first + count; ++number)
    attempts.push_back(test::make_attempt(robot().digest, "shelf", number));
  test::report(*store, std::move(attempts));
}

std::uint64_t rows(const StoreCheck& check, const std::string& table) {
  const auto found = std::ranges::find(check.tables, table, &StoreCheck::Table::name);
  return found == check.tables.end() ? 0 : found->rows;
}

/// A store with 5 attempts, and one with 8 whose server was killed: the last is in the WAL only.
class StoreMaintenanceKill : public testing::Test {
 protected:
  static constexpr std::uint64_t kBackupAttempts = 5;
  static constexpr std::uint64_t kOldAttempts = 8;

  StoreMaintenanceKill() {
    fs::create_directory(templates_ / "old");
    add_attempts(backup_, 1, kBackupAttempts);
    const fs::path closed = templates_ / "closed.db";
    add_attempts(closed, 1, kOldAttempts - 1);
    const std::unique_ptr<Store> store = open_sqlite_store(closed);
    test::report(*store, {test::make_attempt(robot().digest, "shelf", 100)});
    for (const std::string suffix : {"", "-wal"})
      fs::copy_file(closed.string() + suffix, (templates_ / "old" / "store.db").string() + suffix);
    old_epoch_ = store->epoch();
  }
  /// A directory with the store of the killed server, as it was.
  void begin_anew() {
    fs::remove_all(place_);
    fs::copy(templates_ / "old", place_);
  }
  std::vector<fs::path> files_with(const std::string& part_of_name) const {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(place_))
      if (entry.path().filename().string().find(part_of_name) != std::string::npos)
        found.push_back(entry.path());
    return found;
  }
  /// Sound, and the old one or the restored one as a whole. \return whether it is the old one.
  bool is_old(const fs::path& file) const {
    const StoreCheck check = check_store(file, ignore);
    EXPECT_EQ(check.problems, 0U) << testing::PrintToString(check.messages);
    // Not by the epoch alone: the store here is a copy, which begins one when it is opened.
    const std::uint64_t attempts = rows(check, "attempt");
    EXPECT_TRUE(attempts == kOldAttempts ||
                (attempts == kBackupAttempts && check.epoch != old_epoch_))
        << attempts;
    return attempts == kOldAttempts;
  }
  bool has_old(const std::vector<fs::path>& files) const {
    return std::ranges::any_of(files, [this](const fs::path& file) {
      return file.extension() != ".lock" && file.extension() != ".high-water-mark" && is_old(file);
    });
  }

  /// Begins anew and kills `verb` before every `step`-th change that it makes, until it is through.
  /// \return how many changes it makes
  template <typename Verb, typename Check>
  int kill_before_each(const Verb& verb, const Check& check, int step = 1) {
    int change = 0;
    for (bool killed = true; killed && !HasFailure(); change += step) {
      SCOPED_TRACE("killed before change " + std::to_string(change));
      begin_anew();
      killed = test::killed_before_change(change, verb);
      check(change);
    }
    return change;
  }

  const test::TemporaryDirectory templates_;
  const fs::path backup_ = templates_ / "backup.db";
  const fs::path place_ = templates_ / "place";
  const fs::path store_ = place_ / "store.db";
  Uuid old_epoch_;
};

TEST_F(StoreMaintenanceKill, ARestoreLeavesTheOldStoreOrTheNewOneAndNeverLosesTheOld) {
  const auto restore = [&] { restore_store(backup_, store_, ignore); };
  const int changes = kill_before_each(restore, [&](int change) {
    ASSERT_TRUE(is_old(store_) || has_old(files_with(".replaced-")));
    if (change % 4 != 0)
      return;
    ASSERT_NO_THROW(restore());  // once more, to the end
    ASSERT_FALSE(is_old(store_));
    ASSERT_TRUE(has_old(files_with(".replaced-")));
    ASSERT_TRUE(files_with(".restoring").empty());
  });
  EXPECT_GT(changes, 20);
}

TEST_F(StoreMaintenanceKill, ABackupIsWholeOrNotThereAndCanBeMadeAfterwards) {
  const fs::path copy = place_ / "copy.db";
  const auto back_up = [&] { backup_store(store_, copy, ignore); };
  const auto check = [&](int) {
    ASSERT_TRUE(is_old(store_));
    if (!fs::exists(copy))
      back_up();
    ASSERT_TRUE(is_old(copy));
    ASSERT_TRUE(files_with(".part").empty());
  };
  EXPECT_GT(kill_before_each(back_up, check), 10);
  const auto back_up_running = [&] {
    const std::unique_ptr<Store> store = open_sqlite_store(store_);
    static_cast<void>(store->backup(copy, [](double) { return true; }).value_or_throw());
  };
  EXPECT_GT(kill_before_each(back_up_running, check, 3), 20);
}

TEST_F(StoreMaintenanceKill, AStoreThatWasBeingMadeIsMadeByTheNextServer) {
  const fs::path fresh = place_ / "fresh.db";
  const auto open = [&] { open_sqlite_store(fresh); };
  const int changes = kill_before_each(open, [&](int) {
    ASSERT_NO_THROW(open());
    ASSERT_EQ(check_store(fresh, ignore).problems, 0U);
  });
  EXPECT_GT(changes, 20);
}

TEST_F(StoreMaintenanceKill, AMigrationHappensWhollyOrNotAtAll) {
  const auto migrations = test::with_next_schema();
  const auto migrate = [&] { open_migrated(store_, migrations); };
  const int changes = kill_before_each(migrate, [&](int) {
    const std::int64_t version = Database(store_, Access::ReadWrite).integer("PRAGMA user_version");
    const bool is_done = version == std::ssize(migrations);
    ASSERT_TRUE(is_done || version == test::schema_of_today()) << version;
    const fs::path backup = backup_of_version(store_, test::schema_of_today());
    ASSERT_TRUE(!is_done || fs::exists(backup));
    ASSERT_TRUE(!fs::exists(backup) || is_old(backup));
    ASSERT_TRUE(is_done || is_old(store_));
    migrate();  // and goes on from there
    test::undo_next_schema(store_);
    ASSERT_TRUE(is_old(store_));
  });
  EXPECT_GT(changes, 20);
}

}  // namespace
}  // namespace kinship::store::store_maintenance_kill_test
