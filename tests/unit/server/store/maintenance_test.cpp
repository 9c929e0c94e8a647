#include "server/store/maintenance.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "proto/types/store_epoch.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/opening/high_water_mark_file.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "server/store/tables/settings.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::maintenance_test {
namespace {

namespace fs = std::filesystem;

void ignore(double) {}

/// A store with something in every table, closed.
class Maintenance : public testing::Test {
 protected:
  Maintenance() { fill(file_, 1); }

  static void fill(const fs::path& file, std::uint64_t first) {
    const std::unique_ptr<Store> store = open_sqlite_store(file);
    const RobotRecord panda = test::make_robot("panda", 1);
    static_cast<void>(store->register_robot(panda));
    for (std::uint64_t number = first; number < first + 4; ++number) {
      Attempt attempt = test::make_attempt(panda.digest, "shelf", number);
      if (number == first)
        attempt.scene = RecordedScene{
            {{"table", BoxShape{{1, 1, 0.1}}}, {"bench", BoxShape{{1, 1, 0.1}}}}, {}, {}};
      attempt.record.sampling_mode = number % 2 == 0 ? SamplingMode::Guided : SamplingMode::Control;
      attempt.record.processor_time_s = 0.125 * static_cast<double>(number);
      attempt.record.machine_speed = 2;
      attempt.record.hand_length_m = static_cast<double>(number);
      attempt.record.least_clearance_m = 0.02;
      test::report(*store, {attempt, test::make_unsolved(panda.digest, "shelf", 1000 + number)});
    }
    static_cast<void>(store->retire_path(test::id_from<Uuid>(first + 3)));
    store->put_distribution(test::make_distribution(panda.digest, "shelf", 1));
    store->put_distribution(test::make_distribution(panda.digest, "shelf", 2));
    store->evict_distribution(test::id_from<Digest>(2));
  }
  void edit(const std::string& sql) const {
    Database database(file_, Access::ReadWrite);
    database.execute(sql);
    ASSERT_GT(database.changed_rows(), 0) << sql;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_.path()))
      found.push_back(entry.path().filename());
    std::ranges::sort(found);
    return found;
  }
  template <typename Verb>
  static Error refusal(Verb verb) {
    try {
      verb();
    } catch (const Failure& failure) {
      return failure.error();
    }
    return {ErrorCode::Internal, "not refused"};
  }

  const test::TemporaryDirectory directory_;
  const fs::path file_ = directory_ / "store.db";
  const fs::path copy_ = directory_ / "copy.db";
};

TEST_F(Maintenance, ASoundStoreIsCheckedAndLeftAsItIs) {
  const std::vector<std::string> before = names();
  const fs::file_time_type written = fs::last_write_time(file_);
  double last = 0;
  const StoreCheck check = check_store(file_, [&](double progress) {
    EXPECT_GE(progress, last);
    last = progress;
  });
  EXPECT_EQ(check.problems, 0U) << testing::PrintToString(check.messages);
  EXPECT_EQ(last, 1);
  EXPECT_EQ(check.schema_version, embedded_migrations().size());
  EXPECT_EQ(check.release, KINSHIP_VERSION);
  EXPECT_EQ(check.epoch, open_sqlite_store(file_)->epoch());
  EXPECT_EQ(check.retired_paths, 1U);
  EXPECT_EQ(check.damaged_paths, 0U);
  const auto rows = [&](const std::string& table) {
    return std::ranges::find(check.tables, table, &StoreCheck::Table::name)->rows;
  };
  EXPECT_EQ(rows("robot"), 1U);
  EXPECT_EQ(rows("path"), 4U);
  EXPECT_EQ(rows("attempt"), 8U);
  EXPECT_EQ(rows("distribution"), 1U);
  EXPECT_EQ(names(), before);
  EXPECT_EQ(fs::last_write_time(file_), written);
}

TEST_F(Maintenance, ACheckNamesTheReleaseThatLastWroteAReport) {
  {
    Database database(file_, Access::ReadWrite);
    database.keep_checksums();
    write_setting(database, "release", "0.0.1");
  }
  static_cast<void>(open_sqlite_store(file_));
  EXPECT_EQ(check_store(file_, ignore).release, "0.0.1") << "opening it changes nothing";
  fill(file_, 100);
  EXPECT_EQ(check_store(file_, ignore).release, KINSHIP_VERSION);
}

TEST_F(Maintenance, ACheckFindsDamageOfEveryKindAndNamesTheRow) {
  const std::vector<std::pair<std::string, std::string>> damages = {
      {"UPDATE path SET waypoints = CAST (substr(waypoints, 1, 50) || x'A5' ||"
       " substr(waypoints, 52) AS BLOB) WHERE id = 2",
       "path: 2: damaged"},
      {"UPDATE path SET waypoints = CAST (substr(waypoints, 1, 50) || x'A5' ||"
       " substr(waypoints, 52) AS BLOB) WHERE id = 4",  // the retired one
       "path: 4: damaged"},
      {"UPDATE path SET T_task_base = NULL WHERE id = 1", "path: 1: damaged"},
      {"UPDATE path SET received_ms = 5 WHERE id = 1", "path 1: arrived at another time"},
      {"DELETE FROM attempt WHERE path_id = 1", "path 1: no attempt has its UUID"},
      {"UPDATE attempt SET path_id = NULL WHERE path_id = 1", "path 1: its attempt does not name"},
      {"UPDATE attempt SET path_id = NULL WHERE path_id = 1", "says 0 dropped paths, has 1"},
      {"UPDATE path SET retired_ms = 1, encoding = 2, waypoints = x'00' WHERE id = 1",
       "path: 1: damaged"},
      {"DELETE FROM distribution_use", "nothing says when it was used"},
      {"UPDATE distribution_use SET id = 99", "used, but not there"},
      {"UPDATE attempt SET path_id = 999 WHERE path_id = 1", "names a path that is not there"},
      {"UPDATE experience SET paths = paths + 1", "says 4 paths, has 3"},
      {"UPDATE experience SET attempts = 3", "says 3 attempts, has 8"},
      {"UPDATE experience SET guided_checks = guided_checks + 1", "its guided attempts are wrong"},
      {"UPDATE experience SET control_solved = 0", "its control attempts are wrong"},
      {"UPDATE distribution SET payload = CAST (payload || x'00' AS BLOB)", "damaged (checksum)"},
      {"UPDATE evicted_distribution SET digest = (SELECT digest FROM distribution)",
       "evicted, but there"},
      {"UPDATE scene SET size = size + 1 WHERE encoding = 2", "scene: 1: damaged"},
      {"UPDATE path SET scene_id = NULL WHERE scene_id = 1", "has another scene than its attempt"},
      {"UPDATE attempt SET scene_id = 9 WHERE scene_id = 1", "names a scene that is not there"},
      {"UPDATE robot SET urdf = urdf || ' '", "robot: 'panda': its row is damaged"},
      {"DELETE FROM robot_held_joint WHERE joint = 'finger_1'", "robot: 'panda'"},
      {"UPDATE setting SET value = 'x' WHERE key = 'epoch'", "epoch is missing or no UUID"},
      {"DELETE FROM setting WHERE key = 'epoch'", "epoch is missing or no UUID"},
      {"DELETE FROM task", "names a task that is not there"}};
  fs::copy_file(file_, copy_);
  for (const auto& [sql, words] : damages) {
    edit(sql);
    const StoreCheck check = check_store(file_, ignore);
    EXPECT_GT(check.problems, 0U) << sql;
    EXPECT_TRUE(std::ranges::any_of(check.messages,
                                    [&, &words = words](const std::string& message) {
                                      return message.find(words) != std::string::npos;
                                    }))
        << sql << ": " << testing::PrintToString(check.messages);
    fs::copy_file(copy_, file_, fs::copy_options::overwrite_existing);
  }
}

TEST_F(Maintenance, ACheckReadsEveryPage) {
  // An index that disagrees with its table, and a page of nonsense.
  {
    Database database(file_, Access::ReadWrite);
    database.execute("PRAGMA journal_mode = DELETE");
  }
  const std::uintmax_t size = fs::file_size(file_);
  std::size_t found = 0;
  std::size_t pages = 0;
  fs::copy_file(file_, copy_);
  for (std::uintmax_t page = 1; page < size / 4096; ++page, ++pages) {
    std::fstream(file_, std::ios::in | std::ios::out | std::ios::binary)
        .seekp(static_cast<std::streamoff>(page * 4096))
        .write(std::string(4096, 'x').data(), 4096);
    if (refusal([&] {
          if (check_store(file_, ignore).problems > 0)
            throw Failure(ErrorCode::Storage, "found");
        }).code == ErrorCode::Storage)
      ++found;
    fs::copy_file(copy_, file_, fs::copy_options::overwrite_existing);
  }
  EXPECT_GT(pages, 10U);
  EXPECT_EQ(found, pages);
}

TEST_F(Maintenance, AStoreOfAKilledServerIsCheckedWithItsWal) {
  const test::TemporaryDirectory elsewhere;
  {
    const std::unique_ptr<Store> store = open_sqlite_store(file_);
    test::report(*store, {test::make_attempt(test::id_from<Digest>(1), "shelf", 50)});
    for (const char* const name : {"store.db", "store.db-wal"})  // as a killed server leaves them
      fs::copy_file(directory_ / name, elsewhere / name);
  }
  const std::uintmax_t wal = fs::file_size(elsewhere / "store.db-wal");
  EXPECT_GT(wal, 0U);
  const StoreCheck check = check_store(elsewhere / "store.db", ignore);
  EXPECT_EQ(check.problems, 0U);
  EXPECT_EQ(fs::file_size(elsewhere / "store.db-wal"), wal);
  EXPECT_EQ(open_sqlite_store(elsewhere / "store.db")->status().attempts, 9U);
}

TEST_F(Maintenance, EveryVerbRefusesWhatIsMissingOpenOrNoStore) {
  const auto each = [&](const fs::path& file) {
    return std::vector<Error>{refusal([&] { check_store(file, ignore); }),
                              refusal([&] { backup_store(file, directory_ / "new", ignore); }),
                              refusal([&] { migrate_store(file); })};
  };
  for (const Error& error : each(directory_ / "none" / "none.db")) {
    EXPECT_EQ(error.code, ErrorCode::NotFound);
    EXPECT_NE(error.message.find("none.db'"), std::string::npos);
  }
  EXPECT_FALSE(fs::exists(directory_ / "none"));
  EXPECT_EQ(refusal([&] { restore_store(directory_ / "none", file_, ignore); }).code,
            ErrorCode::NotFound);
  std::ofstream(directory_ / "text") << "no store";
  std::ofstream(directory_ / "empty") << "";
  for (const char* const name : {"text", "empty"}) {
    for (const Error& error : each(directory_ / name))
      EXPECT_EQ(error.code, ErrorCode::Storage) << error.message;
    EXPECT_EQ(refusal([&] { restore_store(directory_ / name, file_, ignore); }).code,
              ErrorCode::Storage);
  }
  backup_store(file_, copy_, ignore);
  const std::unique_ptr<Store> served = open_sqlite_store(file_);
  for (const Error& error : each(file_))
    EXPECT_EQ(error.code, ErrorCode::Unavailable) << error.message;
  EXPECT_EQ(refusal([&] { restore_store(copy_, file_, ignore); }).code, ErrorCode::Unavailable);
  EXPECT_FALSE(fs::exists(directory_ / "new"));
}

TEST_F(Maintenance, ABackupReplacesNothing) {
  std::ofstream(copy_) << "mine";
  const Error error = refusal([&] { backup_store(file_, copy_, ignore); });
  EXPECT_EQ(error.code, ErrorCode::Conflict);
  EXPECT_NE(error.message.find(copy_.string()), std::string::npos);
  EXPECT_EQ(fs::file_size(copy_), 4U);
}

TEST_F(Maintenance, ARestoredStoreIsThatOfTheBackupUnderANewEpoch) {
  backup_store(file_, copy_, ignore);
  const Uuid before = open_sqlite_store(file_)->epoch();
  fill(file_, 100);  // all this is not in the backup
  const Restored restored = restore_store(copy_, file_, ignore);
  EXPECT_NE(restored.epoch, before);
  EXPECT_TRUE(restored.leftovers.empty());
  EXPECT_EQ(check_store(copy_, ignore).epoch, before);
  const std::unique_ptr<Store> store = open_sqlite_store(file_);
  EXPECT_EQ(store->epoch(), restored.epoch);
  EXPECT_EQ(store->status().attempts, 8U);
  EXPECT_FALSE(store->find_attempt(test::id_from<Uuid>(100)));
  const std::string stamp = restored.replaced.filename().string();
  EXPECT_EQ(stamp.size(), std::string("store.db.replaced-20261121T000000Z").size()) << stamp;
  EXPECT_EQ(check_store(restored.replaced, ignore).problems, 0U);
  EXPECT_EQ(check_store(restored.replaced, ignore).epoch, before);
  EXPECT_TRUE(open_sqlite_store(restored.replaced)->find_attempt(test::id_from<Uuid>(100)));
}

TEST_F(Maintenance, ARestoreKeepsWhatAKilledServerLeftInItsWal) {
  backup_store(file_, copy_, ignore);
  const test::TemporaryDirectory elsewhere;
  {
    const std::unique_ptr<Store> store = open_sqlite_store(file_);
    test::report(*store, {test::make_attempt(test::id_from<Digest>(1), "shelf", 50)});
    for (const char* const name : {"store.db", "store.db-wal"})
      fs::copy_file(directory_ / name, elsewhere / name);
  }
  const Restored restored = restore_store(copy_, elsewhere / "store.db", ignore);
  EXPECT_EQ(open_sqlite_store(elsewhere / "store.db")->status().attempts, 8U);
  EXPECT_TRUE(open_sqlite_store(restored.replaced)->find_attempt(test::id_from<Uuid>(50)));
}

TEST_F(Maintenance, ARestoreIntoNothingMakesAStore) {
  const fs::path fresh = directory_ / "deep" / "fresh.db";
  const Restored restored = restore_store(file_, fresh, ignore);
  EXPECT_TRUE(restored.replaced.empty());
  EXPECT_EQ(open_sqlite_store(fresh)->status().attempts, 8U);
}

TEST_F(Maintenance, ARestoreRefusesADamagedBackupAndChangesNothing) {
  backup_store(file_, copy_, ignore);
  Database(copy_, Access::ReadWrite).execute("UPDATE path SET crc32c = 1 WHERE id = 2");
  const std::vector<std::string> before = names();
  const Uuid epoch = open_sqlite_store(file_)->epoch();
  const Error error = refusal([&] { restore_store(copy_, file_, ignore); });
  EXPECT_EQ(error.code, ErrorCode::Storage);
  EXPECT_NE(error.message.find("path: 2: damaged"), std::string::npos) << error.message;
  EXPECT_NE(error.message.find(copy_.string()), std::string::npos) << error.message;
  EXPECT_EQ(names(), before);
  EXPECT_EQ(open_sqlite_store(file_)->epoch(), epoch);
  EXPECT_EQ(refusal([&] { restore_store(file_, file_, ignore); }).code, ErrorCode::InvalidInput);
}

TEST_F(Maintenance, ARepairKeepsWhatWasMeasuredAndACheckComparesIt) {
  const auto means = [this] { return open_sqlite_store(file_)->status().guided_means.value(); };
  const PathMeans before = means();
  EXPECT_EQ(before.attempts, 2U);
  EXPECT_EQ(before.hand_length_m, 3);
  repair_store(file_, ignore);
  EXPECT_EQ(means().attempts, before.attempts);
  EXPECT_DOUBLE_EQ(means().time_s, before.time_s);
  EXPECT_DOUBLE_EQ(means().length, before.length);
  EXPECT_DOUBLE_EQ(means().hand_length_m, before.hand_length_m);
  EXPECT_DOUBLE_EQ(means().least_clearance_m, before.least_clearance_m);
  edit("UPDATE experience SET guided_hand_length_m = guided_hand_length_m + 1");
  const StoreCheck check = check_store(file_, ignore);
  ASSERT_FALSE(check.messages.empty());
  EXPECT_NE(
      testing::PrintToString(check.messages).find("the sums of its guided attempts are wrong"),
      std::string::npos)
      << testing::PrintToString(check.messages);
}

TEST_F(Maintenance, ARepairedStoreHasItsNameFromItsSettingsOrElseFromItsMark) {
  const Uuid before = open_sqlite_store(file_)->epoch();
  fs::remove(HighWaterMarkFile::name_of(file_));
  repair_store(file_, ignore);
  const Uuid repaired = open_sqlite_store(file_)->epoch();
  EXPECT_NE(repaired, before);
  EXPECT_TRUE(is_same_store(repaired, before)) << "clients send again what the damage took";
  ASSERT_TRUE(fs::exists(HighWaterMarkFile::name_of(file_)));
  edit("UPDATE setting SET value = '" + next_epoch({}).text() + "' WHERE key = 'epoch'");
  repair_store(file_, ignore);
  const Uuid again = open_sqlite_store(file_)->epoch();
  EXPECT_NE(again, repaired);
  EXPECT_TRUE(is_same_store(again, before)) << "the row is damaged";
}

TEST_F(Maintenance, ARestoreReplacesAStoreThatNobodyCanReadAndKeepsIt) {
  backup_store(file_, copy_, ignore);
  fs::resize_file(file_, 5000);
  const Restored restored = restore_store(copy_, file_, ignore);
  EXPECT_EQ(fs::file_size(restored.replaced), 5000U);
  EXPECT_EQ(open_sqlite_store(file_)->status().attempts, 8U);
}

TEST_F(Maintenance, TwoRestoresInOneSecondKeepBothStoresAndNameThem) {
  backup_store(file_, copy_, ignore);
  const Restored first = restore_store(copy_, file_, ignore);
  const Restored second = restore_store(copy_, file_, ignore);
  EXPECT_NE(first.replaced, second.replaced);
  EXPECT_EQ(second.leftovers, std::vector<fs::path>{first.replaced});
  EXPECT_EQ(check_store(second.replaced, ignore).epoch, first.epoch);
}

TEST_F(Maintenance, AStoreOfTodayIsNotMigrated) {
  const Migrated migrated = migrate_store(file_);
  EXPECT_EQ(migrated.from, embedded_migrations().size());
  EXPECT_EQ(migrated.to, migrated.from);
  EXPECT_TRUE(migrated.backup.empty());
}

TEST_F(Maintenance, EveryVerbRefusesAStoreOfANewerSchema) {
  edit("PRAGMA user_version = 9; INSERT INTO setting (key, value) VALUES ('newer', '')");
  for (const Error& error : {refusal([&] { check_store(file_, ignore); }),
                             refusal([&] { backup_store(file_, copy_, ignore); }),
                             refusal([&] { migrate_store(file_); }),
                             refusal([&] { restore_store(file_, directory_ / "new", ignore); })}) {
    EXPECT_EQ(error.code, ErrorCode::Storage);
    EXPECT_NE(error.message.find("has schema 9; this binary knows up to " +
                                 std::to_string(embedded_migrations().size()) + "; "),
              std::string::npos)
        << error.message;
    EXPECT_NE(error.message.find("'kinship paths export'"), std::string::npos) << error.message;
  }
  EXPECT_FALSE(fs::exists(copy_));
}

}  // namespace
}  // namespace kinship::store::maintenance_test
