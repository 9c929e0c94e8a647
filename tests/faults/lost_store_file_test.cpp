// The file that is written is the file that is named, and has what was written: what an
// administrator's hand may do to the files of a store that kinshipd serves, or to those of one that
// it left behind when it was killed.

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <string>

#include "tests/faults/served_store.hpp"
#include "tests/support/small_file_system.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::lost_store_file_test {
namespace {

namespace fs = std::filesystem;
using test::Answer;
using test::ServedStore;

constexpr std::uint64_t kReports = 20;
constexpr std::chrono::seconds kSoon{1};

void make_empty(const fs::path& file) { std::ofstream{file}; }

/// As `dd conv=notrunc` does.
void overwrite(const fs::path& file, std::uint64_t place, std::size_t bytes) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(place));
  stream << std::string(bytes, '\x55');
}

class LostStoreFile : public testing::Test {
 protected:
  void SetUp() override {
    store_.report(kReports);
    ASSERT_EQ(store_.cell().status().attempts, kReports);
  }

  /// Does it, and waits until status and log say so, without any report.
  void lose(const std::function<void()>& attack, const std::string& words) {
    attack();
    const auto done = std::chrono::steady_clock::now();
    ServerStatus said;
    EXPECT_TRUE(store_.status_becomes([&](const ServerStatus& status) {
      said = status;
      return !status.writable;
    }));
    EXPECT_LT(std::chrono::steady_clock::now() - done, kSoon);
    EXPECT_TRUE(store_.status_becomes([&](const ServerStatus& status) {
      said = status;
      return status.storage_message.find("being saved") == std::string::npos;
    }));
    expect_says(said.storage_message, words);
    EXPECT_FALSE(store_.offer()) << "a report was acknowledged that nobody finds";
    expect_says(store_.cell().log(), words);
  }
  void expect_says(const std::string& text, const std::string& words) const {
    for (const std::string& part :
         {"not writable: '" + store_.file().string() + "' is not the file any more: ", words})
      EXPECT_NE(text.find(part), std::string::npos) << part << "\nin: " << text;
  }
  void expect_all_when_it_goes_on() {
    EXPECT_TRUE(store_.status_becomes([](const ServerStatus& status) { return status.writable; }));
    expect_all_in_the_end();
  }
  void expect_all_in_the_end() {
    EXPECT_TRUE(store_.has_all_receipts());
    store_.report(1);
    EXPECT_EQ(store_.cell().terminate(), 0);
    EXPECT_EQ(store_.missing(store_.file()), 0U);
  }
  /// The client offers again what the copy lacks, so that all is there in the end.
  void expect_all_once_offered_again(std::uint64_t reports) {
    restore_rescued(true);
    EXPECT_TRUE(store_.status_becomes(
        [&](const ServerStatus& status) { return status.attempts >= reports; }));
    expect_all_in_the_end();
  }
  /// So that the store's file has all, and the WAL nothing.
  void start_again() {
    EXPECT_EQ(store_.cell().terminate(), 0);
    store_.cell().start();
  }
  /// The one copy that the server made before it is killed, put in the store's place.
  void restore_rescued(bool repair_it = false) {
    store_.cell().kill();
    const auto rescued = store_.named("fleet.db.rescued-");
    ASSERT_EQ(rescued.size(), 1U);
    if (repair_it) {
      EXPECT_EQ(ServedStore::offline_of(rescued[0], "repair").code, 0);
    }
    const Answer answer = store_.offline("restore", {rescued[0].string()});
    ASSERT_EQ(answer.code, 0) << answer.err;
    store_.cell().start();
  }

  ServedStore store_;
};

TEST_F(LostStoreFile, RemovedIsSavedBesideIt) {
  lose([&] { fs::remove(store_.file()); }, "it was removed; all of it is in '");
  const Answer started = store_.start_in_vain(store_.file());
  EXPECT_NE(started.code, 0);
  restore_rescued();
  expect_all_in_the_end();
}

TEST_F(LostStoreFile, RemovedIsSavedOnceThatCanBe) {
  const pid_t server = store_.cell().server().pid();
  rlimit before{};
  ASSERT_EQ(prlimit(server, RLIMIT_NOFILE, nullptr, &before), 0);
  const rlimit none{1, before.rlim_max};
  ASSERT_EQ(prlimit(server, RLIMIT_NOFILE, &none, nullptr), 0);
  lose([&] { fs::remove(store_.file()); }, "it was removed; nothing could be saved yet: ");
  const std::string open_file = "/proc/" + std::to_string(server) + "/fd/";
  EXPECT_NE(store_.cell().status().storage_message.find(open_file), std::string::npos);
  ASSERT_EQ(prlimit(server, RLIMIT_NOFILE, &before, nullptr), 0);
  EXPECT_TRUE(store_.status_becomes([](const ServerStatus& status) {
    return status.storage_message.find("all of it is in '") != std::string::npos;
  }));
  restore_rescued();
  expect_all_in_the_end();
}

TEST_F(LostStoreFile, MovedIsWholeThereAndGoesOnWhenItIsBack) {
  const fs::path elsewhere = store_.folder() / "old.db";
  lose([&] { fs::rename(store_.file(), elsewhere); },
       "it was moved, it is '" + elsewhere.string() + "' now; all of it is there");
  EXPECT_EQ(store_.named("fleet.db.rescued-").size(), 0U);
  fs::rename(elsewhere, store_.file());
  expect_all_when_it_goes_on();
  expect_says(store_.cell().log(), "' is the file again");
}

TEST_F(LostStoreFile, ReplacedIsSavedAndTheOtherFileIsLeftAlone) {
  const fs::path other = store_.beside() / "other.db";
  {
    test::Stranger stranger(other, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    stranger.run("CREATE TABLE t (x); INSERT INTO t VALUES (7)");
  }
  const std::string content = test::read_text(other);
  lose([&] { fs::rename(other, store_.file()); }, "another file was put in its place; all of it");
  EXPECT_EQ(test::read_text(store_.file()), content);
  restore_rescued();
  expect_all_in_the_end();
}

TEST_F(LostStoreFile, TruncatedIsSavedAsFarAsItIsThere) {
  // Nothing was checkpointed yet but the first page: all is in the WAL.
  lose([&] { fs::resize_file(store_.file(), 0); }, "it was truncated to 0 bytes; what is left");
  const Answer started = store_.start_in_vain(store_.file());
  EXPECT_TRUE(started.says("the file is empty, but '")) << started.err;
  restore_rescued(true);
  expect_all_in_the_end();
}

TEST_F(LostStoreFile, WhoseFolderWasMovedGoesOnWhenItIsBack) {
  const fs::path elsewhere = store_.beside() / "elsewhere";
  lose([&] { fs::rename(store_.folder(), elsewhere); },
       "its folder is '" + elsewhere.string() + "' now, it is whole there");
  EXPECT_EQ(store_.cell().status().attempts, kReports) << "as counted before";
  fs::rename(elsewhere, store_.folder());
  EXPECT_EQ(store_.named("fleet.db.rescued-").size(), 0U);
  expect_all_when_it_goes_on();
}

TEST_F(LostStoreFile, WithoutItsFolderIsSavedAboveIt) {
  lose([&] { fs::remove_all(store_.folder()); }, "it was removed; all of it is in '");
  store_.cell().kill();
  fs::path rescued;
  for (const auto& entry : fs::directory_iterator(store_.beside()))
    if (entry.path().filename().string().starts_with("fleet.db.rescued-"))
      rescued = entry.path();
  ASSERT_FALSE(rescued.empty());
  EXPECT_EQ(store_.missing(rescued), 1U) << "only what was not acknowledged";
}

TEST_F(LostStoreFile, WithoutItsWalGoesOnByItself) {
  fs::remove(store_.wal());
  const auto is_noticed = [this](const ServerStatus&) {
    return store_.cell().log().find("is the file again") != std::string::npos;
  };
  EXPECT_TRUE(store_.status_becomes(is_noticed));
  expect_says(store_.cell().log(), "the store itself has all reports");
  expect_all_when_it_goes_on();
}

TEST_F(LostStoreFile, WithAnotherWalGoesOnWhenThatIsAway) {
  const fs::path other = store_.beside() / "wal";
  std::ofstream(other) << "no WAL at all";
  lose([&] { fs::rename(other, store_.wal()); }, "another file has the name of its WAL");
  EXPECT_EQ(test::read_text(store_.wal()), "no WAL at all");
  fs::remove(store_.wal());
  expect_all_when_it_goes_on();
}

/// In a namespace of its own, with the server.
class StoreAmongMounts : public testing::Test {
 protected:
  void SetUp() override {
    if (!own_namespace_.is_mounted())
      GTEST_SKIP() << "nothing can be mounted here: " << own_namespace_.why();
    store_ = std::make_unique<ServedStore>();
    store_->report(kReports);
  }

  const test::TemporaryDirectory apart_;
  const test::SmallFileSystem own_namespace_{apart_.path(), "1m"};
  std::unique_ptr<ServedStore> store_;
};

TEST_F(StoreAmongMounts, BelowOneGoesOnWhenThatIsGone) {
  ASSERT_EQ(mount("tmpfs", store_->folder().c_str(), "tmpfs", 0, "size=1m"), 0);
  EXPECT_TRUE(store_->status_becomes([](const ServerStatus& status) {
    return !status.writable &&
           status.storage_message.find(
               "another file system is mounted over its folder, it is whole below that") !=
               std::string::npos;
  }));
  EXPECT_FALSE(store_->offer());
  ASSERT_EQ(umount(store_->folder().c_str()), 0);
  EXPECT_TRUE(store_->has_all_receipts());
  EXPECT_EQ(store_->cell().terminate(), 0);
  EXPECT_EQ(store_->missing(store_->file()), 0U);
}

// --- its content ---

constexpr std::size_t kPage = 4096;

/// Within the fifth frame of a WAL, which a transaction with reports has.
constexpr std::uint64_t kInWal = 32 + 4 * (24 + kPage) + 1000;

TEST_F(LostStoreFile, OverwrittenByAnotherOneIsSavedAsFarAsItIsThere) {
  const fs::path other = store_.beside() / "other.db";
  {
    test::Stranger stranger(other, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    stranger.run("CREATE TABLE t (x); INSERT INTO t VALUES (7)");
  }
  lose([&] { fs::copy_file(other, store_.file(), fs::copy_options::overwrite_existing); },
       "; what is left of it is in '");
  restore_rescued(true);
  expect_all_in_the_end();  // all was in the WAL
}

TEST_F(LostStoreFile, WhoseHeaderIsOverwrittenIsSavedAsFarAsItIsThere) {
  start_again();
  store_.report(3);
  lose([&] { overwrite(store_.file(), 0, kPage); }, "it was overwritten; what is left of it is in");
  expect_all_once_offered_again(kReports + 3);
}

TEST_F(LostStoreFile, OverwrittenAfterACrashIsNoticed) {
  store_.cell().kill();
  store_.cell().start();
  const std::uint64_t size = fs::file_size(store_.file());
  lose([&] { overwrite(store_.file(), size / kPage / 2 * kPage, kPage); },
       "it was overwritten; what is left of it is in");
  expect_all_once_offered_again(kReports);
}

TEST_F(LostStoreFile, WithATruncatedWalSaysHowFarItIsSaved) {
  start_again();
  store_.report(3);
  lose([&] { fs::resize_file(store_.wal(), 0); },
       "its WAL '" + store_.wal().string() + "' was truncated to 0 bytes; what is left of it is");
  EXPECT_NE(store_.cell().status().storage_message.find(std::to_string(kReports + 3) +
                                                        " were acknowledged: stop kinshipd"),
            std::string::npos)
      << store_.cell().status().storage_message;
  expect_all_once_offered_again(kReports + 3);
}

TEST_F(LostStoreFile, WithHalfAWalIsSavedAsFarAsThatGoes) {
  lose([&] { fs::resize_file(store_.wal(), kInWal); }, "bytes; what is left of it is in '");
  expect_all_once_offered_again(kReports);
}

TEST_F(LostStoreFile, WhoseWalIsOverwrittenInItsMiddleIsNoticed) {
  lose([&] { overwrite(store_.wal(), kInWal, 100); },
       "its WAL '" + store_.wal().string() + "' was overwritten; what is left of it is in '");
  expect_all_once_offered_again(kReports);
}

TEST_F(LostStoreFile, MovesNothingOfASpoiltWalWhenItStops) {
  overwrite(store_.wal(), kInWal, 100);
  EXPECT_EQ(store_.cell().terminate(), 0);
  expect_says(store_.cell().log(), "was overwritten; what is left of it is in '");
  expect_all_once_offered_again(kReports);
}

TEST_F(LostStoreFile, GoesOnWithoutAWalThatWasMovedAlready) {
  std::size_t logged = 0;
  for (const std::uint64_t bytes : {kInWal, std::uint64_t{0}}) {
    store_.report(10);
    test::Stranger(store_.file()).run("PRAGMA wal_checkpoint(PASSIVE)");
    fs::resize_file(store_.wal(), bytes);
    EXPECT_TRUE(store_.status_becomes([&](const ServerStatus&) {
      return store_.cell().log().find("is the file again", logged) != std::string::npos;
    }));
    const std::string log = store_.cell().log().substr(logged);
    EXPECT_NE(log.find("bytes; the store itself has all reports"), std::string::npos) << log;
    logged += log.size();
  }
  expect_all_when_it_goes_on();
}

TEST(StoreThatIsLost, AnswersReportsWhileItIsBeingSaved) {
  const test::TemporaryDirectory folder;
  const store::RobotRecord robot = test::make_robot("panda", 1);
  std::promise<void> saved, may_go_on;
  const auto log = [&, goes_on = may_go_on.get_future().share()](std::string_view line) {
    if (line.find("all of it is in '") == std::string_view::npos)
      return;
    saved.set_value();
    goes_on.wait();
  };
  const auto store = store::open_sqlite_store(
      folder / "store.db",
      {.retry_after = std::chrono::milliseconds(1), .scrub_bytes_per_s = 0, .log = log});
  ASSERT_TRUE(store->register_robot(robot));
  fs::remove(folder / "store.db");
  saved.get_future().wait();
  auto answer = std::async(std::launch::async, [&] {
    return test::report(*store, {test::make_attempt(robot.digest, "shelf", 1)}).at(0);
  });
  EXPECT_EQ(answer.wait_for(test::Cell::kEnough), std::future_status::ready);
  may_go_on.set_value();
  EXPECT_EQ(answer.get().status, ReceiptStatus::TryAgain);
}

// --- at the start ---

TEST_F(LostStoreFile, IsNoNewStoreWhileItsWalIsThere) {
  store_.cell().kill();
  const fs::path away = store_.beside() / "away.db";
  fs::rename(store_.file(), away);
  const auto wal_bytes = fs::file_size(store_.wal());
  const Answer started = store_.start_in_vain(store_.file());
  EXPECT_NE(started.code, 0);
  for (const char* const part : {"the file is missing, but '", "fleet.db-wal'", "--new-store"})
    EXPECT_TRUE(started.says(part)) << part << "\nin: " << started.err;
  EXPECT_FALSE(fs::exists(store_.file()));
  EXPECT_EQ(fs::file_size(store_.wal()), wal_bytes);
  make_empty(store_.file());
  EXPECT_TRUE(store_.start_in_vain(store_.file()).says("the file is empty, but '"));
  fs::rename(away, store_.file());
  store_.cell().start();
  expect_all_in_the_end();
}

TEST_F(LostStoreFile, IsNoNewStoreWhileItsMarkOrItsLockIsThere) {
  EXPECT_EQ(store_.cell().terminate(), 0);
  fs::remove(store_.file());
  EXPECT_TRUE(store_.start_in_vain(store_.file()).says("fleet.db.high-water-mark'"));
  fs::remove(store_.file().string() + ".high-water-mark");
  EXPECT_TRUE(store_.start_in_vain(store_.file()).says("fleet.db.lock' is there"));
}

TEST_F(LostStoreFile, IsReplacedByANewOneOnDemandAlone) {
  store_.cell().kill();
  EXPECT_TRUE(store_.start_in_vain(store_.file(), {"--new-store"}).says("is there; --new-store"));
  const std::string wal = test::read_text(store_.wal());
  fs::remove(store_.file());
  {
    const test::ReservedDomain domain;
    test::ServerProcess server(
        {.store = store_.file(), .domain = domain.number(), .arguments = {"--new-store"}});
    EXPECT_EQ(server.terminate(), 0);
  }
  EXPECT_EQ(store_.missing(store_.file()), kReports);
  const auto aside = store_.named("fleet.db.replaced-");
  ASSERT_FALSE(aside.empty());
  std::string kept;
  for (const fs::path& path : aside)
    if (path.extension() == ".wal")
      kept = test::read_text(path);
  EXPECT_EQ(kept, wal);
}

// --- its lock ---

TEST_F(LostStoreFile, IsLockedAlsoWhenTheLockFileIsRemoved) {
  fs::remove(store_.file().string() + ".lock");
  const Answer second = store_.start_in_vain(store_.file());
  EXPECT_NE(second.code, 0);
  EXPECT_TRUE(second.says("is open in another server, process ")) << second.err;
  EXPECT_FALSE(second.says("process unknown")) << second.err;
  EXPECT_NE(store_.offline("check").code, 0);
  expect_all_in_the_end();
}

TEST_F(StoreAmongMounts, ThatIsOneIsRefusedWithTheFolderToMount) {
  const test::TemporaryDirectory container;
  const fs::path mounted = container / "fleet.db";
  make_empty(mounted);
  ASSERT_EQ(mount(store_->file().c_str(), mounted.c_str(), nullptr, MS_BIND, nullptr), 0);
  const Answer second = store_->start_in_vain(mounted);
  EXPECT_NE(second.code, 0);
  EXPECT_TRUE(second.says("is mounted by itself")) << second.err;
  EXPECT_TRUE(second.says("mount the folder '" + container.path().string())) << second.err;
  const Answer check = ServedStore::offline_of(mounted, "check");
  EXPECT_TRUE(check.says("is open in another server, process " +
                         std::to_string(store_->cell().server().pid())))
      << check.err;
  umount(mounted.c_str());
}

}  // namespace
}  // namespace kinship::lost_store_file_test
