#include "server/store/sqlite/sqlite_store.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <future>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/opening/connection.hpp"
#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store::sqlite_store_test {
namespace {

Engine sqlite_engine() {
  const auto open_in = [](const std::filesystem::path& directory, const EngineLimits& limits) {
    SqliteOptions options;
    options.max_paths_per_pair = limits.paths_per_pair;
    options.max_distribution_bytes = limits.distribution_bytes;
    options.searches = limits.searches;
    return open_sqlite_store(directory / "store.db", options);
  };
  return {"Sqlite", open_in, Engine::BackupInstant::End};
}
std::string name_of_engine(const testing::TestParamInfo<Engine>& engine) {
  return engine.param.name;
}
INSTANTIATE_TEST_SUITE_P(Sqlite, StoreConformance, testing::Values(sqlite_engine()),
                         name_of_engine);
INSTANTIATE_TEST_SUITE_P(Sqlite, StoreRetention, testing::Values(sqlite_engine()), name_of_engine);
INSTANTIATE_TEST_SUITE_P(Sqlite, StoreSharing, testing::Values(sqlite_engine()), name_of_engine);
INSTANTIATE_TEST_SUITE_P(Sqlite, StoreBackup, testing::Values(sqlite_engine()), name_of_engine);
INSTANTIATE_TEST_SUITE_P(Sqlite, StoreRetentionBackup, testing::Values(sqlite_engine()),
                         name_of_engine);

/// What only a store in an SQLite file can show.
class SqliteStoreTest : public testing::Test {
 protected:
  void open() {
    store_.reset();
    store_ = open_sqlite_store(file_);
    static_cast<void>(store_->register_robot(robot_));
  }
  Attempt attempt(std::uint64_t number) const {
    return test::make_attempt(robot_.digest, "shelf", number);
  }
  /// Something that wrote to the file behind the server's back; the store is closed.
  void damage(const std::string& sql) {
    store_.reset();
    Database database(file_, Access::ReadWrite);
    database.execute(sql);
    ASSERT_GT(database.changed_rows(), 0) << sql;
  }
  std::string refusal() const {
    try {
      open_sqlite_store(file_);
    } catch (const Failure& failure) {
      return failure.what();
    }
    return "";
  }
  /// Waits until what a reader handed to the writer is committed.
  void drain() { test::report(*store_, {}); }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "store.db";
  const RobotRecord robot_ = test::make_robot("panda", 1);
  std::unique_ptr<Store> store_;
};

TEST_F(SqliteStoreTest, ADistributionThatIsUsedOutlivesNewerOnesThatAreNot) {
  store_ = open_sqlite_store(file_, {.max_distribution_bytes = 6000});
  static_cast<void>(store_->register_robot(robot_));
  test::begin_task(*store_, robot_.digest, "shelf");
  const auto put = [&](std::uint64_t number) {
    store_->put_distribution(test::make_distribution(robot_.digest, "shelf", number));
  };
  put(1);
  put(2);
  damage("UPDATE distribution_use SET used_ms = used_ms - 7200000");  // two hours ago
  store_ = open_sqlite_store(file_, {.max_distribution_bytes = 6000});
  store_->note_use(test::id_from<Digest>(1));
  for (std::uint64_t number = 3; store_->find_distribution(test::id_from<Digest>(2)); ++number)
    put(number);
  EXPECT_TRUE(store_->find_distribution(test::id_from<Digest>(1)));
}

constexpr const char* kFlipByte =
    "UPDATE path SET waypoints = CAST (substr(waypoints, 1, 50) || x'A5' ||"
    " substr(waypoints, 52) AS BLOB) WHERE id = 2";

TEST_F(SqliteStoreTest, SetsADamagedPathAside) {
  open();
  test::report(*store_, {attempt(1), attempt(2), attempt(3)});
  damage(kFlipByte);
  open();
  const auto paths = store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 2});
  ASSERT_EQ(paths.size(), 2U);  // a full page, without the damaged one
  EXPECT_EQ(paths[0].report_uuid, test::id_from<Uuid>(1));
  EXPECT_EQ(paths[1].report_uuid, test::id_from<Uuid>(3));
  drain();
  const StoreStatus status = store_->status();
  EXPECT_EQ(status.paths, 2U);
  EXPECT_EQ(status.attempts, 3U);
  EXPECT_NE(status.message.find("1 damaged path"), std::string::npos) << status.message;
  EXPECT_EQ(store_->generation(robot_.digest, "shelf"), 2U);  // a fit with it is stale
  EXPECT_EQ(store_->list_paths({}, "", "", 10).rows.size(), 2U);
}

TEST_F(SqliteStoreTest, SetsADamagedSceneAsideUntilItComesAgain) {
  open();
  Attempt first = attempt(1), second = attempt(2);
  first.scene = second.scene = RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}}}, {}, {}};
  test::report(*store_, {first});
  damage(
      "UPDATE scene SET scene = CAST (substr(scene, 1, 20) || x'A5' || substr(scene, 22) AS BLOB)");
  open();
  const auto paths = store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 2});
  ASSERT_EQ(paths.size(), 1U);  // the path is read all the same
  ASSERT_TRUE(paths[0].scene_id);
  EXPECT_FALSE(store_->read_scene(*paths[0].scene_id));
  drain();
  EXPECT_NE(store_->status().message.find("1 damaged scene"), std::string::npos)
      << store_->status().message;
  EXPECT_FALSE(store_->find_attempt(first.report_uuid)->scene);
  EXPECT_TRUE(store_->find_attempt(first.report_uuid)->path);
  EXPECT_EQ(store_->export_attempts({}, "", "", 9, 1'000'000).rows.size(), 1U);

  test::report(*store_, {second});
  EXPECT_TRUE(store_->read_scene(*paths[0].scene_id));
  EXPECT_EQ(store_->status().message.find("damaged scene"), std::string::npos);
}

TEST_F(SqliteStoreTest, ASceneUnderAnothersDigestIsDamaged) {
  open();
  Attempt first = attempt(1);
  first.scene = RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}}}, {}, {}};
  test::report(*store_, {first});
  damage("UPDATE scene SET content_sha256 = randomblob(32)");
  open();
  EXPECT_FALSE(store_->find_attempt(first.report_uuid)->scene);
}

TEST_F(SqliteStoreTest, ReopeningAfterAFailureSetsADamagedPathAsideAndGoesOn) {
  open();
  test::report(*store_, {attempt(1), attempt(2), attempt(3)});
  damage(kFlipByte);
  EXPECT_NO_THROW(reopen_writer(file_));
  open();
  EXPECT_EQ(store_->status().paths, 2U);
  EXPECT_NE(store_->status().message.find("1 damaged path"), std::string::npos);
  EXPECT_EQ(store_->generation(robot_.digest, "shelf"), 2U);  // a fit with it is stale
}

TEST_F(SqliteStoreTest, AnAttemptOfADamagedPathIsShownWithoutIt) {
  open();
  test::report(*store_, {attempt(1), attempt(2)});
  damage(kFlipByte);
  open();
  const std::optional<Attempt> found = store_->find_attempt(test::id_from<Uuid>(2));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->record.collision_checks, 1234U);
  EXPECT_FALSE(found->path);
}

TEST_F(SqliteStoreTest, TakesTheContentOfADamagedPathAgain) {
  open();
  test::report(*store_, {attempt(1), attempt(2)});
  damage(kFlipByte);
  open();
  store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 10});
  drain();
  Attempt again = attempt(9);
  again.path = attempt(2).path;
  EXPECT_EQ(test::report(*store_, {again})[0].status, ReceiptStatus::Stored);
  EXPECT_EQ(store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 10}).size(), 2U);
}

TEST_F(SqliteStoreTest, TheChecksumCoversPlacementAndShapeToo) {
  const std::vector<std::string> edits = {
      "T_task_base = NULL",
      "T_task_base = CAST (substr(T_task_base, 1, 48) || x'0000000000000000' AS BLOB)",
      "report_uuid = zeroblob(16)", "crc32c = crc32c - 1"};
  for (const std::string& edit : edits) {
    open();
    const Attempt fresh = attempt(100 + store_->status().attempts);
    test::report(*store_, {fresh});
    const std::size_t before =
        store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 100}).size();
    damage("UPDATE path SET " + edit + " WHERE id = (SELECT max(id) FROM path)");
    open();
    EXPECT_EQ(store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 100}).size(),
              before - 1)
        << edit;
  }
}

TEST_F(SqliteStoreTest, ServesNoDamagedDistribution) {
  open();
  test::begin_task(*store_, robot_.digest, "shelf");
  const Distribution distribution = test::make_distribution(robot_.digest, "shelf", 1);
  store_->put_distribution(distribution);
  damage("UPDATE distribution SET payload = CAST (payload || x'00' AS BLOB)");
  open();
  EXPECT_FALSE(store_->find_distribution(distribution.id));
  EXPECT_EQ(store_->put_distribution(distribution), 2U);  // fitted again: the count goes on
  EXPECT_TRUE(store_->find_distribution(distribution.id));
}

TEST_F(SqliteStoreTest, ServesNoDamagedRobot) {
  open();
  damage("UPDATE robot_held_joint SET position = 0.03 WHERE joint = 'finger_1'");
  store_ = open_sqlite_store(file_);
  EXPECT_TRUE(store_->robots().empty());
  EXPECT_THROW(store_->find_robot(robot_.digest), Failure);
  EXPECT_NE(store_->status().message.find("1 damaged robot"), std::string::npos);
}

TEST_F(SqliteStoreTest, RegisteringADamagedRobotAgainRepairsItAndKeepsItsPaths) {
  open();
  test::report(*store_, {attempt(1)});
  for (const char* edit : {"UPDATE robot_held_joint SET position = 0.03 WHERE joint = 'finger_1'",
                           "UPDATE robot SET label = 'pandb', urdf = urdf || 'x'",
                           "DELETE FROM robot_never_colliding"}) {
    damage(edit);
    store_ = open_sqlite_store(file_);
    ASSERT_TRUE(store_->robots().empty()) << edit;
    EXPECT_EQ(*store_->register_robot(robot_), RegisterStatus::Registered) << edit;
    EXPECT_EQ(store_->status().message.find("damaged robot"), std::string::npos);
    const std::optional<RobotRecord> robot = store_->find_robot(robot_.digest);
    ASSERT_TRUE(robot) << edit;
    EXPECT_EQ(robot->description.label, "panda");
    EXPECT_EQ(robot->description.held_joints, robot_.description.held_joints);
    EXPECT_EQ(robot->description.never_colliding, robot_.description.never_colliding);
    EXPECT_EQ(store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 10}).size(), 1U);
    EXPECT_EQ(*store_->register_robot(robot_), RegisterStatus::Known);
  }
}

TEST_F(SqliteStoreTest, AnswersTryAgainWhenTooMuchWaits) {
  store_ = open_sqlite_store(file_, {.max_queued_bytes = 15'000});
  ASSERT_TRUE(store_->register_robot(robot_));
  std::promise<void> busy;
  std::promise<void> go_on;
  store_->commit_reports({}, [&](const std::vector<Receipt>&) {  // keeps the writer from writing
    busy.set_value();
    go_on.get_future().wait();
  });
  busy.get_future().wait();
  std::vector<std::future<std::vector<Receipt>>> answers;
  for (std::uint64_t i = 0; i < 100; ++i) {
    auto answer = std::make_shared<std::promise<std::vector<Receipt>>>();
    answers.push_back(answer->get_future());
    store_->commit_reports({attempt(i)}, [answer](const std::vector<Receipt>& receipts) {
      answer->set_value(receipts);
    });
  }
  EXPECT_EQ(store_->status().queued, 100U);
  go_on.set_value();
  std::size_t stored = 0;
  for (auto& answer : answers) {
    const Receipt receipt = answer.get().at(0);
    if (receipt.status == ReceiptStatus::Stored)
      ++stored;
    else
      EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain);
  }
  EXPECT_GT(stored, 5U);
  EXPECT_LT(stored, 30U);
  EXPECT_EQ(store_->status().paths, stored);
  EXPECT_EQ(test::report(*store_, {attempt(99)})[0].status, ReceiptStatus::Stored);
}

TEST_F(SqliteStoreTest, MakesItsDirectoryForTheOwnerAlone) {
  store_ = open_sqlite_store(directory_ / "a" / "b" / "store.db");
  EXPECT_EQ(std::filesystem::status(directory_ / "a" / "b").permissions(),
            std::filesystem::perms::owner_all);
}

TEST_F(SqliteStoreTest, SaysWhichDirectoryItCannotMake) {
  std::ofstream(directory_ / "file") << "x";
  try {
    open_sqlite_store(directory_ / "file" / "store.db");
    FAIL() << "a store below a file";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(failure.what()).find("file'"), std::string::npos) << failure.what();
  }
}

TEST_F(SqliteStoreTest, RefusesAFileOfSomebodyElseAndLeavesItAlone) {
  Database(file_, Access::Create).execute("CREATE TABLE t (x)");
  const auto size = std::filesystem::file_size(file_);
  EXPECT_NE(refusal().find("no Kinship store"), std::string::npos);
  EXPECT_EQ(std::filesystem::file_size(file_), size);
  EXPECT_EQ(Database(file_, Access::ReadOnly).integer("PRAGMA application_id"), 0);
}

TEST_F(SqliteStoreTest, RefusesWhatCannotBeAStoreBeforeItMakesALock) {
  const std::string name = "store '" + file_.string() + "': ";
  const std::filesystem::path lock = file_.string() + ".lock";
  for (const std::string& text :
       {std::string("root:x:0:0:root:/root:/bin/sh\n"), std::string("x")}) {
    std::ofstream(file_) << text;
    EXPECT_EQ(refusal().find(name + "is no SQLite database; "), 0U) << refusal();
    EXPECT_FALSE(std::filesystem::exists(lock));
  }
  std::filesystem::remove(file_);
  std::filesystem::create_directory(file_);
  EXPECT_EQ(refusal(), name + "is a directory");
  std::filesystem::remove(file_);
  std::filesystem::create_symlink(directory_ / "nowhere", file_);
  EXPECT_EQ(refusal(), name + "is a link to a file that does not exist");
  EXPECT_FALSE(std::filesystem::exists(lock));
}

TEST_F(SqliteStoreTest, RefusesAFileWithASecondName) {
  open();
  store_.reset();
  std::filesystem::create_hard_link(file_, directory_ / "other.db");
  EXPECT_NE(refusal().find("has 2 names"), std::string::npos) << refusal();
  std::filesystem::remove(directory_ / "other.db");
  EXPECT_EQ(refusal(), "");
}

TEST_F(SqliteStoreTest, NamesTheFileInEveryRefusal) {
  const std::string name = "store '" + file_.string() + "': ";
  std::ofstream(file_) << std::string("SQLite format 3\0", 16) << std::string(8176, 'x');
  EXPECT_EQ(refusal().find(name), 0U) << refusal();
  std::ofstream(file_) << std::string(5000, 'x');  // its lock file is there now
  EXPECT_EQ(refusal().find(name), 0U) << refusal();
}

TEST_F(SqliteStoreTest, MakesItsFileForTheOwnerAlone) {
  open();
  EXPECT_EQ(std::filesystem::status(file_).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(SqliteStoreTest, RefusesANewerSchema) {
  open();
  store_.reset();
  Database(file_, Access::ReadWrite).execute("PRAGMA user_version = 1000");
  EXPECT_NE(refusal().find("has schema 1000"), std::string::npos);
}

TEST_F(SqliteStoreTest, RefusesASecondServerAlsoThroughALink) {
  open();
  std::filesystem::create_symlink(file_, directory_ / "link.db");
  const std::filesystem::path link = directory_ / "link.db";
  const pid_t child = fork();
  if (child == 0) {
    try {
      open_sqlite_store(link);
    } catch (const Failure& failure) {
      _exit(failure.code() == ErrorCode::Unavailable ? 0 : 1);
    }
    _exit(2);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(SqliteStoreTest, LeavesOneFileTheLockAndTheHighWaterMarkBehind) {
  open();
  test::report(*store_, {attempt(1)});
  store_.reset();
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory_.path()))
    names.push_back(entry.path().filename());
  std::ranges::sort(names);
  EXPECT_EQ(names,
            (std::vector<std::string>{"store.db", "store.db.high-water-mark", "store.db.lock"}));
}

TEST_F(SqliteStoreTest, WritesInWalModeWithPagesOf4KbAndTheRulesOfItsSchema) {
  open();
  test::report(*store_, {attempt(1), test::make_unsolved(robot_.digest, "shelf", 2)});
  store_.reset();
  Database database(file_, Access::ReadOnly);
  EXPECT_EQ(database.integer("PRAGMA page_size"), 4096);
  EXPECT_EQ(database.integer("SELECT journal_mode = 'wal' FROM pragma_journal_mode"), 1);
  EXPECT_EQ(database.integer("SELECT count(*) FROM pragma_foreign_key_check"), 0);
  EXPECT_EQ(database.integer("SELECT integrity_check = 'ok' FROM pragma_integrity_check"), 1);
}

}  // namespace
}  // namespace kinship::store::sqlite_store_test
