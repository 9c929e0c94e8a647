// kinshipd migrate-store, as processes, with real clusters of PostgreSQL and real servers.

#include <gtest/gtest.h>

#include <sys/wait.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "server/store/maintenance.hpp"
#include "server/store/open_store.hpp"
#include "tests/golden/golden_store.hpp"
#include "tests/integration/moved_store.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/small_file_system.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::migrate_store_test {
namespace {

namespace fs = std::filesystem;

using Ended = test::Answer;

class MigrateStore : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (test::missing_postgres().empty())
      cluster_ = std::make_unique<test::PostgresCluster>();
  }
  static void TearDownTestSuite() { cluster_.reset(); }
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    database_ =
        "of_" + std::to_string(testing::UnitTest::GetInstance()->current_test_info()->line());
    url_ = cluster_->create_database(database_);
  }

  static std::vector<std::string> arguments(const std::string& from, const std::string& to) {
    return {"migrate-store", "--from", from, "--to", to};
  }
  static Ended run(const std::vector<std::string>& arguments) {
    return test::run_to_end("kinshipd", arguments);
  }
  Ended move(const std::string& from, const std::string& to) const {
    return run(arguments(from, to));
  }
  /// What a server says that is to serve it; it is ended if it does.
  Ended serve(const std::string& store) const {
    const test::ReservedDomain domain;
    const fs::path errors = folder_ / "server_errors";
    fs::remove(errors);
    test::Program program("kinshipd",
                          {"--store", store, "--domain", std::to_string(domain.number())}, errors);
    Ended ended;
    ended.out = program.read_line();
    if (ended.out.starts_with("ready "))
      program.signal(SIGTERM);
    ended.code = program.wait();
    ended.err = test::read_text(errors);
    return ended;
  }
  /// Kills one move after the other, each once `rows` have grown by some, until one ends by itself.
  Ended move_killed(const std::string& from, const std::string& to,
                    const std::function<std::int64_t()>& rows, int& kills) const;
  std::int64_t number_there(const std::string& sql) const {
    try {
      return std::stoll(cluster_->query(sql, database_));
    } catch (const std::exception&) {
      return 0;  // no tables yet
    }
  }

  inline static std::unique_ptr<test::PostgresCluster> cluster_;
  const test::TemporaryDirectory folder_;
  const std::string file_ = (folder_ / "site.db").string(), back_ = (folder_ / "back.db").string();
  std::string database_, url_;
};

constexpr const char* kAttempts = "SELECT count(*) FROM attempt";

/// Where another sees nothing of what a process does, it looks again soon.
void look_again() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

/// Of a store that another process writes: to open it would be in the way.
std::int64_t bytes_of(const std::string& store) {
  std::error_code error;
  std::int64_t bytes = 0;
  for (const char* const part : {"", "-wal"})
    if (const std::uintmax_t size = fs::file_size(store + part, error); !error)
      bytes += static_cast<std::int64_t>(size);
  return bytes;
}

Ended MigrateStore::move_killed(const std::string& from, const std::string& to,
                                const std::function<std::int64_t()>& rows, int& kills) const {
  constexpr std::int64_t kStep = 700;
  for (std::int64_t limit = kStep;; limit += kStep) {
    const fs::path errors = folder_ / "errors";
    fs::remove(errors);
    test::Program program("kinshipd", arguments(from, to), errors);
    while (kill(program.pid(), 0) == 0 && rows() < limit) {
      siginfo_t info{};
      waitid(P_PID, static_cast<id_t>(program.pid()), &info, WEXITED | WNOHANG | WNOWAIT);
      if (info.si_pid != 0)
        return {program.wait(), program.read_all(), test::read_text(errors)};
      look_again();
    }
    program.signal(SIGKILL);
    if (const int code = program.wait(); code != 128 + SIGKILL)
      return {code, program.read_all(), test::read_text(errors)};
    if (kills++ % 3 == 0) {
      EXPECT_TRUE(serve(to).says("is half a store"));
    }
  }
}

TEST_F(MigrateStore, AllOfAStoreComesToADatabaseAndBack) {
  test::make_full_store(file_);
  const Ended there = move(file_, url_);
  ASSERT_EQ(there.code, 0) << there.out << there.err;
  EXPECT_TRUE(there.says("all rows are the same")) << there.out;
  EXPECT_TRUE(there.says(" is damaged, there as here")) << there.out;
  const Ended back = move(url_, back_);
  ASSERT_EQ(back.code, 0) << back.out << back.err;

  EXPECT_EQ(test::differences_of(file_, back_), "");
  const auto wanted = test::rows_of(file_);
  for (const char* const table :
       {"robot", "robot_held_joint", "robot_never_colliding", "robot_geometry", "task",
        "experience", "scene", "path", "attempt", "distribution", "distribution_use",
        "evicted_distribution", "rehearsal", "audit", "setting", "retired_report", "same_content",
        "quarantine"})
    EXPECT_TRUE(wanted.contains(table)) << "the store to be moved has no " << table;
  const auto quiet = [](double) {};
  EXPECT_EQ(store::check_store(back_, quiet).problems, store::check_store(file_, quiet).problems);

  EXPECT_TRUE(move(file_, url_).says("already"));
  EXPECT_TRUE(serve(file_).says("was moved to '" + url_.substr(0, 11))) << serve(file_).err;
  EXPECT_TRUE(serve(url_).says("was moved to '" + back_ + "'"));
}

TEST_F(MigrateStore, WhatWasAcknowledgedIsKnownAndNothingGivenIsGivenAgain) {
  test::make_full_store(file_);
  std::uint64_t generation = 0, revision = 0;
  const Distribution evicted = test::golden_evicted_distribution();
  const Digest robot = test::attempts_of_full_store()[0].robot;
  {
    const auto store = store::open_sqlite_store(file_);
    generation = store->generation(robot, "carry");
  }
  ASSERT_EQ(move(file_, url_).code, 0);
  {
    const auto store = store::open_store(url_, {});
    EXPECT_EQ(store->generation(robot, "carry"), generation);
    for (const ReceiptStatus status :
         test::statuses(test::report(*store, test::attempts_of_full_store())))
      EXPECT_EQ(status, ReceiptStatus::Duplicate);
    EXPECT_EQ(test::statuses(test::report(*store, {test::make_attempt(robot, "carry", 7777)})),
              std::vector{ReceiptStatus::Stored});
    revision = store->put_distribution(evicted);
    EXPECT_EQ(revision, 2U);
    EXPECT_EQ(store->list_audit("", "", 1).rows.front().verb, "migrate-store");
  }
  ASSERT_EQ(move(url_, back_).code, 0);
  const auto store = store::open_sqlite_store(back_);
  EXPECT_EQ(store->generation(robot, "carry"), generation + 1);
  EXPECT_GT(store->put_distribution(evicted), revision);
  EXPECT_EQ(test::statuses(test::report(*store, {test::make_attempt(robot, "carry", 7777)})),
            std::vector{ReceiptStatus::Duplicate});
}

TEST_F(MigrateStore, ASceneThatWasBroughtAnewIsOneThere) {
  Attempt attempt = test::golden_attempts_with_scene()[0];
  attempt.report_uuid = test::id_from<Uuid>(500);
  attempt.path = test::make_path(500);
  test::make_full_store(file_);
  {
    const auto store = store::open_sqlite_store(file_);
    test::report(*store, {attempt});
  }
  ASSERT_EQ(test::number_in(file_, "SELECT count(*) FROM scene"), 2);
  ASSERT_EQ(move(file_, url_).code, 0);
  const auto store = store::open_store(url_, {});
  for (const Uuid& report :
       {attempt.report_uuid, test::golden_attempts_with_scene()[1].report_uuid})
    EXPECT_TRUE(store->find_attempt(report).value().scene.has_value());
}

TEST_F(MigrateStore, KilledAtAnyTimeItGoesOnAndHalfAStoreIsNotServed) {
  test::make_large_store(file_, 4000);
  int kills = 0;
  const Ended there = move_killed(
      file_, url_, [this] { return number_there(kAttempts); }, kills);
  EXPECT_EQ(there.code, 0) << there.out << there.err;
  EXPECT_GE(kills, 3);
  const int kills_there = kills;
  const Ended back = move_killed(
      url_, back_, [this] { return bytes_of(back_) / 1000; }, kills);
  EXPECT_EQ(back.code, 0) << back.out << back.err;
  EXPECT_GE(kills, kills_there + 3);
  EXPECT_EQ(test::differences_of(file_, back_), "");
}

TEST_F(MigrateStore, KilledWhileItComparesAndClosesTheSourceItGoesOn) {
  test::make_large_store(file_, 3000);
  for (const auto& [from, to] : {std::pair(file_, url_), std::pair(url_, back_)}) {
    test::Program program("kinshipd", arguments(from, to));
    // The source is closed first; then all is copied, compared, and the target opened.
    const auto is_closed = [this, is_file = from == file_] {
      const std::string marks = "SELECT count(*) FROM setting WHERE key = 'moved_to'";
      return (is_file ? test::number_in(file_, marks) : number_there(marks)) == 1;
    };
    while (!is_closed())
      look_again();
    program.signal(SIGKILL);
    ASSERT_EQ(program.wait(), 128 + SIGKILL);
    EXPECT_TRUE(serve(from).says("was moved to '")) << serve(from).err;
    const Ended ended = move(from, to);
    EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
    EXPECT_TRUE(move(from, to).says("already"));
  }
  EXPECT_EQ(test::differences_of(file_, back_), "");
}

TEST_F(MigrateStore, ADatabaseThatDiesIsAnErrorToGoOnFrom) {
  test::make_large_store(file_, 3000);
  test::PostgresCluster own;
  const std::string url = own.create_database("own");
  const auto rows = [&own] {
    try {
      return std::stoll(own.query(kAttempts, "own"));
    } catch (const std::exception&) {
      return 0LL;
    }
  };
  const fs::path errors = folder_ / "lost";
  {
    test::Program program("kinshipd", arguments(file_, url), errors);
    while (rows() < 500)
      look_again();
    own.kill();
    EXPECT_EQ(program.wait(), 1);
  }
  EXPECT_NE(test::read_text(errors), "");
  EXPECT_EQ(move(file_, url).code, 1);  // it is down
  own.start();
  const Ended there = move(file_, url);
  EXPECT_EQ(there.code, 0) << there.out << there.err;
  EXPECT_LT(there.out.find("copied "), there.out.find("all rows are the same"));
}

TEST_F(MigrateStore, HalfAStoreSaysHowToGoOnOrToGiveUp) {
  test::make_large_store(file_, 3000);
  {
    test::Program program("kinshipd", arguments(file_, url_));
    while (number_there(kAttempts) < 500)
      look_again();
    program.signal(SIGKILL);
    program.wait();
  }
  const Ended refused = serve(url_);
  EXPECT_NE(refused.code, 0);
  EXPECT_TRUE(refused.says("kinshipd migrate-store --from " + file_)) << refused.err;
  EXPECT_TRUE(refused.says("--give-up")) << refused.err;
  EXPECT_EQ(number_there("SELECT count(*) FROM epoch"), 0);

  const std::string other = (folder_ / "other.db").string();
  test::make_large_store(other, 10);
  EXPECT_TRUE(move(other, url_).says("is being filled from '" + file_)) << move(other, url_).err;

  EXPECT_EQ(run({"migrate-store", "--give-up", "--to", url_}).code, 0);
  EXPECT_EQ(run({"migrate-store", "--give-up", "--from", file_}).code, 0);
  EXPECT_EQ(move(other, url_).code, 0);
  const Ended full = move(file_, url_);
  EXPECT_EQ(full.code, 1);
  EXPECT_TRUE(full.says("holds a store already")) << full.err;
  EXPECT_TRUE(store::open_sqlite_store(file_)->status().writable);
}

TEST_F(MigrateStore, WhereverTheDiskIsFullItSaysSoAndGoesOnOnceThereIsRoom) {
  test::make_large_store(file_, 2000);
  ASSERT_EQ(move(file_, url_).code, 0);
  fs::create_directory(folder_ / "small");
  const test::SmallFileSystem disk(folder_ / "small", "64k");
  if (!disk.is_mounted())
    GTEST_SKIP() << "no file system may be mounted here: " << disk.why();
  const std::string target = (folder_ / "small" / "back.db").string();
  Ended ended = move(url_, target);
  int failed = 0;
  for (int size_kb = 64; ended.code != 0; ++failed) {
    EXPECT_EQ(ended.code, 1);
    EXPECT_TRUE(ended.says("'" + target + "'")) << ended.err;
    EXPECT_TRUE(ended.says("full") || ended.says("No space left")) << ended.err;
    EXPECT_EQ(number_there("SELECT count(*) FROM setting WHERE key LIKE 'moved_to%'"), 0);
    size_kb += size_kb / 4;
    ASSERT_LT(size_kb, 65536) << ended.err;
    disk.resize(std::to_string(size_kb) + "k");
    ended = move(url_, target);
  }
  EXPECT_GT(failed, 5);
  EXPECT_TRUE(ended.says("all rows are the same")) << ended.out;
  EXPECT_EQ(test::differences_of(file_, target), "");
}

/// The same database, with another host before it, and with parameters in another order.
std::vector<std::string> other_names_of(const std::string& url) {
  const std::string after_scheme = url.substr(url.find("://"));
  const std::size_t query = url.find('?'), next = url.find('&');
  return {"postgres" + after_scheme,
          url.substr(0, query + 1) + url.substr(next + 1) + "&" +
              url.substr(query + 1, next - query - 1),
          url + "&application_name=other&connect_timeout=5",
          url.substr(0, url.find("?host=")) + url.substr(next).replace(0, 1, "?") +
              "&host=/nowhere," + url.substr(query + 6, next - query - 6)};
}

TEST_F(MigrateStore, ATargetIsTheSameByAnyOfItsNames) {
  test::make_large_store(file_, 20);
  ASSERT_EQ(move(file_, url_).code, 0);
  for (const std::string& name : other_names_of(url_)) {
    const Ended again = move(file_, name);
    EXPECT_EQ(again.code, 0) << name << ": " << again.err;
    EXPECT_TRUE(again.says("already")) << name << ": " << again.out;
  }
  const std::string other = cluster_->create_database(database_ + "_other");
  EXPECT_TRUE(move(file_, other).says("was moved to '")) << move(file_, other).err;

  ASSERT_EQ(move(url_, back_).code, 0);
  fs::create_directory(folder_ / "linked");
  fs::create_symlink(back_, folder_ / "linked" / "back.db");
  for (const std::string& name :
       {fs::proximate(back_).string(), (folder_ / "linked" / ".." / "back.db").string(),
        (folder_ / "linked" / "back.db").string()}) {
    const Ended again = move(url_, name);
    EXPECT_EQ(again.code, 0) << name << ": " << again.err;
    EXPECT_TRUE(again.says("already")) << name << ": " << again.out;
  }
  EXPECT_TRUE(move(url_, (folder_ / "third.db").string()).says("was moved to '"));
}

/// A robot that never stops to report, and what it was told is kept.
class Reporter {
 public:
  Reporter(std::uint32_t domain, const fs::path& outbox)
      : client_({.domain = domain, .outbox = outbox, .timeout = kEnough}),
        panda_(client_.register_robot(test::model_description("panda")).value_or_throw().robot) {}
  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;
  ~Reporter() { stop(); }

  void start() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested())
        report_some();
    });
  }
  std::vector<Uuid> stop() {
    thread_ = {};
    return acknowledged_;
  }
  std::size_t acknowledged() const { return count_; }
  /// Until so many more are acknowledged.
  void await(std::size_t more) const {
    const std::size_t wanted = count_ + more;
    const auto end = std::chrono::steady_clock::now() + kEnough;
    while (count_ < wanted && std::chrono::steady_clock::now() < end)
      look_again();
    EXPECT_GE(count_, wanted);
  }

 private:
  static constexpr std::chrono::seconds kEnough{60};

  void report_some() {
    constexpr int kAtOnce = 5;
    std::vector<Uuid> reported;
    for (int i = 0; i < kAtOnce; ++i) {
      const Attempt attempt = test::panda_attempt(panda_, "sweep", ++number_);
      reported.push_back(attempt.report_uuid);
      client_.report(attempt);
    }
    ASSERT_EQ(client_.flush(kEnough).pending, 0U);
    acknowledged_.insert(acknowledged_.end(), reported.begin(), reported.end());
    count_ += reported.size();
  }

  link::Client client_;
  const Digest panda_;
  std::uint64_t number_ = 0;
  std::vector<Uuid> acknowledged_;
  std::atomic<std::size_t> count_ = 0;
  std::jthread thread_;
};

TEST_F(MigrateStore, TheServerServesUntilTheLastSecondAndNothingAcknowledgedIsMissing) {
  const test::ReservedDomain domain;
  const auto serving = [&](const std::string& store) {
    auto server = std::make_unique<test::Program>(
        "kinshipd",
        std::vector<std::string>{"--store", store, "--domain", std::to_string(domain.number())},
        folder_ / "log");
    EXPECT_TRUE(server->read_line().starts_with("ready "));
    return server;
  };
  const auto end = [](std::unique_ptr<test::Program> server) {
    server->signal(SIGTERM);
    EXPECT_EQ(server->wait(), 0);
  };
  std::unique_ptr<test::Program> server = serving(file_);
  Reporter reporter(domain.number(), folder_ / "outbox");
  reporter.start();
  reporter.await(200);

  const Ended beside = move(file_, url_);
  EXPECT_EQ(beside.code, 1);
  EXPECT_TRUE(beside.says("process " + std::to_string(server->pid()))) << beside.out << beside.err;
  EXPECT_TRUE(beside.says("Stop it and run the same command again")) << beside.out;
  EXPECT_GT(number_there(kAttempts), 100);
  reporter.await(50);
  end(std::move(server));
  const Ended there = move(file_, url_);
  EXPECT_EQ(there.code, 0) << there.out << there.err;

  server = serving(url_);
  reporter.await(50);
  const Ended back_beside = move(url_, back_);
  EXPECT_EQ(back_beside.code, 1);
  EXPECT_TRUE(back_beside.says("is open in servers, from addresses local"))
      << back_beside.out << back_beside.err;
  reporter.await(50);
  const std::vector<Uuid> acknowledged = reporter.stop();
  end(std::move(server));
  const Ended back = move(url_, back_);
  EXPECT_EQ(back.code, 0) << back.out << back.err;

  const auto store = store::open_sqlite_store(back_);
  EXPECT_EQ(store->known_reports(acknowledged).size(), acknowledged.size());
  EXPECT_EQ(test::number_in(back_, kAttempts), static_cast<std::int64_t>(acknowledged.size()));
}

}  // namespace
}  // namespace kinship::migrate_store_test
