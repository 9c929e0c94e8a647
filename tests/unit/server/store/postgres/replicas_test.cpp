#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/postgres/postgres_store.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"
#include "tests/support/store_values.hpp"

/// What fits read of standbys: only what is as new as they want, and of the primary whatever a
/// standby cannot tell.
namespace kinship::store::postgres_replicas_test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kDatabase = "fleet";
const std::vector<std::string> kSettings = {"log_statement = 'all'",
                                            "max_standby_streaming_delay = '100ms'"};

std::unique_ptr<test::PostgresCluster> make_primary() {
  auto primary = std::make_unique<test::PostgresCluster>(
      test::PostgresCluster::Options{.name = "a", .settings = kSettings});
  primary->create_database(kDatabase);
  return primary;
}
std::unique_ptr<test::PostgresCluster> make_standby(const test::PostgresCluster& primary,
                                                    const std::string& name) {
  return std::make_unique<test::PostgresCluster>(
      primary, test::PostgresCluster::Options{.name = name, .settings = kSettings});
}

/// Statements that a server ran with that in their text, by its own log.
std::size_t statements(const test::PostgresCluster& cluster, const std::string& part) {
  std::ifstream log(cluster.log());
  std::size_t count = 0;
  for (std::string line; std::getline(log, line);)
    if (line.find(" execute ") != std::string::npos && line.find(part) != std::string::npos)
      ++count;
  return count;
}
std::size_t path_readings(const test::PostgresCluster& cluster) {
  return statements(cluster, "FROM path WHERE task_id = ");
}

bool comes_true(const std::function<bool()>& is_true) {
  for (const auto end = Clock::now() + std::chrono::seconds(20); Clock::now() < end;
       std::this_thread::sleep_for(std::chrono::milliseconds(20)))
    if (is_true())
      return true;
  return false;
}

class PostgresReplicas : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    a_ = make_primary();
    b_ = make_standby(*a_, "b");
    url_ = test::url_of_either(*a_, *b_, kDatabase);
    store_ = open();
    ASSERT_TRUE(store_->register_robot(robot_));
    report(*store_, 1, 5);
    test::wait_until_replayed(*a_, *b_);
  }
  std::unique_ptr<Store> open(PostgresOptions options = {}) const {
    options.retry_after = std::chrono::milliseconds(50);
    return open_postgres_store(url_, options);
  }
  /// Reports until they are stored.
  void report(Store& store, std::uint64_t first, std::uint64_t last) const {
    for (std::uint64_t number = first; number <= last; ++number) {
      Attempt attempt = test::make_attempt(robot_.digest, "shelf", number);
      attempt.scene = RecordedScene{{{"table", BoxShape{{1, 1, 0.1}}}}, {}, {}};
      EXPECT_TRUE(comes_true([&] {
        const ReceiptStatus status = test::report(store, {attempt}).at(0).status;
        return status == ReceiptStatus::Stored || status == ReceiptStatus::Duplicate;
      }));
    }
  }
  std::uint64_t generation() const { return store_->generation(robot_.digest, "shelf"); }
  std::vector<StoredPath> read(const Store& store, std::uint64_t generation) const {
    return store.read_paths(robot_.digest, "shelf", {.limit = 100, .generation = generation});
  }
  std::vector<Uuid> reports_read(const Store& store, std::uint64_t generation) const {
    std::vector<Uuid> reports;
    for (const StoredPath& path : read(store, generation))
      reports.push_back(path.report_uuid);
    return reports;
  }
  ReplicaUse use_of(const Store& store, const test::PostgresCluster& cluster) const {
    for (const ReplicaUse& use : store.status().replicas)
      if (use.host.find(cluster.folder()) != std::string::npos)
        return use;
    ADD_FAILURE() << "no host " << cluster.folder();
    return {};
  }
  /// Reads while the standby does not answer: one that was asked in vain is left alone for a while.
  void expect_one_failure_a_second(int readings, Clock::duration at_most) const {
    const Clock::time_point begin = Clock::now();
    for (int i = 0; i < readings; ++i)
      EXPECT_EQ(read(*store_, generation()).size(), 5U);
    const auto took = std::chrono::floor<std::chrono::seconds>(Clock::now() - begin);
    EXPECT_LT(took, at_most);
    EXPECT_GE(use_of(*store_, *b_).failed, 1U);
    EXPECT_LE(use_of(*store_, *b_).failed, 1U + static_cast<std::uint64_t>(took.count()));
  }
  void pause(bool is_paused) const {
    b_->query(is_paused ? "SELECT pg_wal_replay_pause()" : "SELECT pg_wal_replay_resume()");
    test::wait_until_true(b_->url(), is_paused ? "SELECT pg_get_wal_replay_pause_state() = 'paused'"
                                               : "SELECT NOT pg_is_wal_replay_paused()");
  }

  std::unique_ptr<test::PostgresCluster> a_, b_;
  std::string url_;
  std::unique_ptr<Store> store_;
  const RobotRecord robot_ = test::make_robot("panda", 1);
};

TEST_F(PostgresReplicas, AFitReadsAStandbyThatHasWhatItWants) {
  const std::size_t on_a = path_readings(*a_), on_b = path_readings(*b_);
  const std::vector<StoredPath> paths = read(*store_, generation());
  EXPECT_EQ(paths.size(), 5U);
  EXPECT_EQ(store_->path_ids(robot_.digest, "shelf", generation()).size(), 5U);
  EXPECT_TRUE(store_->read_scene(paths.at(0).scene_id.value()));
  EXPECT_EQ(path_readings(*a_), on_a);
  EXPECT_EQ(path_readings(*b_), on_b + 2);
  EXPECT_EQ(statements(*a_, "FROM scene WHERE id = "), 0U);
  EXPECT_EQ(statements(*b_, "FROM scene WHERE id = "), 1U);
  EXPECT_EQ(use_of(*store_, *b_).readings, 3U);
  EXPECT_EQ(use_of(*store_, *b_).message, "");
  EXPECT_EQ(use_of(*store_, *a_).readings, 0U);

  EXPECT_EQ(read(*store_, 0).size(), 5U) << "as they are now: that only the primary knows";
  EXPECT_EQ(path_readings(*a_), on_a + 1);
  EXPECT_EQ(path_readings(*b_), on_b + 2);

  const std::unique_ptr<Store> alone = open({.read_replicas = false});
  EXPECT_EQ(read(*alone, generation()).size(), 5U);
  EXPECT_EQ(path_readings(*b_), on_b + 2);
  EXPECT_TRUE(alone->status().replicas.empty());
}

TEST_F(PostgresReplicas, AStandbyThatIsBehindIsNotReadForWhatItDoesNotHave) {
  pause(true);
  const std::uint64_t before = generation();
  report(*store_, 6, 6);
  const auto retired = store_->retire_path(test::id_from<Uuid>(2));
  ASSERT_TRUE(retired) << retired.error().message;
  EXPECT_EQ(reports_read(*store_, generation()), test::uuids_from({1, 3, 4, 5, 6}))
      << "what is retired is in no fit of that generation";
  EXPECT_EQ(store_->path_ids(robot_.digest, "shelf", generation()).size(), 5U);
  EXPECT_EQ(use_of(*store_, *b_).behind, 2U);
  EXPECT_EQ(use_of(*store_, *b_).readings, 0U);
  EXPECT_NE(use_of(*store_, *b_).message.find("behind"), std::string::npos);

  const std::unique_ptr<Store> other = open();
  pause(false);
  test::wait_until_replayed(*a_, *b_);  // the beginning of its run
  pause(true);
  report(*store_, 7, 7);
  EXPECT_EQ(reports_read(*other, before), test::uuids_from({1, 3, 4, 5, 6}))
      << "new enough for that";
  EXPECT_EQ(use_of(*other, *b_).readings, 1U);
  EXPECT_EQ(reports_read(*other, generation()), test::uuids_from({1, 3, 4, 5, 6, 7}));
  EXPECT_EQ(reports_read(*other, before), test::uuids_from({1, 3, 4, 5, 6, 7}))
      << "never from before what was read last";
  EXPECT_EQ(use_of(*other, *b_).readings, 1U);

  pause(false);
  test::wait_until_replayed(*a_, *b_);
  EXPECT_EQ(reports_read(*other, generation()), test::uuids_from({1, 3, 4, 5, 6, 7}));
  EXPECT_EQ(use_of(*other, *b_).readings, 2U);
  EXPECT_EQ(use_of(*other, *b_).message, "");
}

TEST_F(PostgresReplicas, AStandbyThatIsGoneCostsNoReadingAndLittleTime) {
  EXPECT_EQ(read(*store_, generation()).size(), 5U);
  b_->kill();
  expect_one_failure_a_second(20, std::chrono::seconds(3));
  EXPECT_NE(use_of(*store_, *b_).message, "");
  b_->start();
  EXPECT_TRUE(comes_true([&] {
    EXPECT_EQ(read(*store_, generation()).size(), 5U);
    return use_of(*store_, *b_).readings > 1;
  })) << "it is read again";
}

TEST_F(PostgresReplicas, AStandbyThatHangsHoldsUpOneReading) {
  constexpr std::chrono::seconds kPatience{1};
  store_ = open({.patience = kPatience});
  test::wait_until_replayed(*a_, *b_);
  EXPECT_EQ(read(*store_, generation()).size(), 5U);
  EXPECT_EQ(use_of(*store_, *b_).readings, 1U);
  b_->freeze();
  expect_one_failure_a_second(5, 3 * kPatience);
  EXPECT_NE(use_of(*store_, *b_).message.find("no answer"), std::string::npos);
  b_->thaw();
}

/// A standby ends a reading that keeps it from replaying the log.
TEST_F(PostgresReplicas, AReadingThatAStandbyEndsIsOneOfThePrimary) {
  const std::uint64_t wanted = generation();
  postgres::Connection locks{postgres::ConnectionString(a_->url(kDatabase))};
  locks.execute("BEGIN; LOCK TABLE path IN ACCESS EXCLUSIVE MODE");
  a_->query("SELECT pg_switch_wal()");
  const std::string is_locked =
      "SELECT EXISTS (SELECT FROM pg_locks WHERE relation = '%'::regclass AND"
      " mode = 'AccessExclusiveLock' AND granted)";
  const auto locked = [&](const std::string& table) {
    return std::string(is_locked).replace(is_locked.find('%'), 1, table);
  };
  test::wait_until_true(b_->url(kDatabase), locked("path"));
  std::future<std::vector<StoredPath>> paths =
      std::async(std::launch::async, [&] { return read(*store_, wanted); });
  // It has read the generation there, and waits for the paths.
  test::wait_until_true(b_->url(kDatabase),
                        "SELECT EXISTS (SELECT FROM pg_locks WHERE NOT granted)");
  locks.execute("LOCK TABLE experience IN ACCESS EXCLUSIVE MODE");
  a_->query("SELECT pg_switch_wal()");
  test::wait_until_true(b_->url(kDatabase), locked("experience"));
  locks.execute("ROLLBACK");
  EXPECT_EQ(paths.get().size(), 5U);
  EXPECT_EQ(use_of(*store_, *b_).failed, 1U);
  EXPECT_NE(use_of(*store_, *b_).message.find("conflict with recovery"), std::string::npos)
      << use_of(*store_, *b_).message;
  test::wait_until_replayed(*a_, *b_);
  EXPECT_EQ(read(*store_, wanted).size(), 5U);
  EXPECT_EQ(use_of(*store_, *b_).readings, 1U) << "it is asked again at once";
}

TEST_F(PostgresReplicas, AStandbyThatWasPromotedIsThePrimary) {
  EXPECT_EQ(read(*store_, generation()).size(), 5U);
  EXPECT_EQ(use_of(*store_, *b_).readings, 1U);
  test::lose_primary(*a_, *b_);
  b_->promote();
  report(*store_, 6, 6);
  EXPECT_TRUE(comes_true([&] {
    EXPECT_EQ(read(*store_, generation()).size(), 6U);
    return use_of(*store_, *b_).message == "it is the primary";
  })) << use_of(*store_, *b_).message;
  EXPECT_EQ(use_of(*store_, *b_).readings, 1U);
  EXPECT_GT(store_->path_ids(robot_.digest, "shelf").back(), 1'000'000)
      << "no id of a path that the old primary alone had comes again";
  a_->rewind_and_follow(*b_);
  EXPECT_TRUE(comes_true([&] {
    EXPECT_EQ(read(*store_, generation()).size(), 6U);
    return use_of(*store_, *a_).readings > 0;
  })) << "the old primary follows the new one, and is read: "
      << use_of(*store_, *a_).message;
  EXPECT_EQ(use_of(*store_, *b_).readings, 1U);
}

/// A standby of the lost primary that had more of it than the one that was promoted.
TEST_F(PostgresReplicas, AStandbyOfAnotherHistoryIsNotRead) {
  const std::unique_ptr<test::PostgresCluster> c = make_standby(*a_, "c");
  url_ = test::url_of_either(*a_, *b_, kDatabase);
  url_.replace(url_.find(a_->folder()), a_->folder().string().size(),
               c->folder().string() + "," + a_->folder().string());
  store_ = open();
  test::wait_until_replayed(*a_, *b_);
  std::unique_ptr<Store> other = open();
  test::wait_until_replayed(*a_, *b_);
  b_->freeze_receiver();
  report(*other, 6, 6);  // of a server that dies, too
  test::wait_until_replayed(*a_, *c);
  other.reset();
  test::lose_primary(*a_, *b_);
  b_->promote();
  EXPECT_TRUE(comes_true([&] {
    try {
      return generation() == 5 && store_->status().writable;
    } catch (const Failure&) {
      return false;
    }
  }));
  EXPECT_EQ(c->query("SELECT generation FROM experience", kDatabase), "6");
  EXPECT_TRUE(comes_true([&] {
    EXPECT_EQ(reports_read(*store_, generation()), test::uuids_from({1, 2, 3, 4, 5}));
    return use_of(*store_, *c).behind > 0;
  })) << use_of(*store_, *c).message;
  EXPECT_EQ(use_of(*store_, *c).readings, 0U);
  report(*store_, 7, 7);
  EXPECT_EQ(reports_read(*store_, generation()), test::uuids_from({1, 2, 3, 4, 5, 7}));
}

}  // namespace
}  // namespace kinship::store::postgres_replicas_test
