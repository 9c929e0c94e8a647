#include "tests/support/postgres_cluster.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <future>
#include <stdexcept>
#include <string>

#include "tests/support/pgbouncer.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"

/// What tests of the second engine rely on.
namespace kinship::test::postgres_cluster_test {
namespace {

using std::string;

const string kCount = "SELECT count(*) FROM seen";
const string kInsert = "INSERT INTO seen SELECT 1 + (SELECT count(*) FROM seen)";
/// As a client whose commits wait for the standby.
const string kDurably = "SET synchronous_commit = on; ";

class PostgresPair : public testing::Test {
 protected:
  void SetUp() override {
    if (const string missing = missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    primary_ = std::make_unique<PostgresCluster>(PostgresCluster::Options{
        .name = "a", .settings = {"synchronous_standby_names = 'ANY 1 (a, b)'"}});
    primary_->query("CREATE TABLE seen (n bigint)");
    standby_ = std::make_unique<PostgresCluster>(*primary_, PostgresCluster::Options{.name = "b"});
  }

  std::unique_ptr<PostgresCluster> primary_, standby_;
};

TEST(PostgresCluster, KeepsWhatWasCommittedWhenAllItsProcessesAreKilled) {
  if (const string missing = missing_postgres(); !missing.empty())
    GTEST_SKIP() << missing;
  PostgresCluster cluster;
  cluster.create_database("pattern");
  cluster.query("CREATE TABLE seen (n bigint)", "pattern");
  const string url = cluster.create_database("one", "pattern");
  query_postgres(url, kInsert);

  cluster.kill();
  EXPECT_THROW(query_postgres(url, kCount), std::runtime_error);
  cluster.start();
  EXPECT_EQ(query_postgres(url, kCount), "1");
  EXPECT_EQ(cluster.query(kCount, "pattern"), "0");

  cluster.stop();
  cluster.start();
  EXPECT_EQ(query_postgres(url, kCount), "1");
  cluster.drop_database("one");
  EXPECT_THROW(query_postgres(url, kCount), std::runtime_error);
}

TEST(PostgresCluster, EndsWithTheTestThatStartedIt) {
  if (const string missing = missing_postgres(); !missing.empty())
    GTEST_SKIP() << missing;
  int ends[2] = {};
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    PostgresCluster cluster;
    const string url = cluster.url();
    if (write(ends[1], url.data(), url.size()) < 0)
      _exit(1);
    ::kill(getpid(), SIGKILL);
  }
  close(ends[1]);
  string url;
  char c = 0;
  while (read(ends[0], &c, 1) == 1)  // until the last process that has the pipe ends, the cluster
    url += c;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
  EXPECT_THROW(query_postgres(url, "SELECT 1"), std::runtime_error);
  const std::size_t begin = url.find("host=") + 5;
  std::filesystem::remove_all(url.substr(begin, url.find('&') - begin));
}

TEST_F(PostgresPair, ACommitWaitsForTheStandbyAndOutlivesThePrimary) {
  query_postgres(primary_->url(), kDurably + kInsert);
  standby_->freeze_receiver();
  std::future<string> waiting = std::async(std::launch::async, [&] {
    try {
      query_postgres(primary_->url(), kDurably + kInsert);
      return string("committed");
    } catch (const std::runtime_error&) {
      return string("in doubt");
    }
  });
  wait_until_true(primary_->url(),
                  "SELECT EXISTS (SELECT FROM pg_stat_activity WHERE wait_event = 'SyncRep')");

  lose_primary(*primary_, *standby_);
  EXPECT_EQ(waiting.get(), "in doubt");
  standby_->promote();
  const string either = url_of_either(*primary_, *standby_, "postgres");
  EXPECT_EQ(query_postgres(either, kCount), "1");  // what was in the frozen socket is lost
  query_postgres(either, kInsert);
  EXPECT_EQ(standby_->query(kCount), "2");

  primary_->rewind_and_follow(*standby_);
  query_postgres(standby_->url(), kDurably + kInsert);
  wait_until_replayed(*standby_, *primary_);
  EXPECT_EQ(primary_->query(kCount), "3");
  EXPECT_EQ(primary_->query("SELECT pg_is_in_recovery()"), "t");
}

TEST_F(PostgresPair, AnOldPrimaryThatComesBackIsASecondOne) {
  lose_primary(*primary_, *standby_);
  standby_->promote();
  primary_->start();
  EXPECT_EQ(primary_->query("SELECT pg_is_in_recovery()"), "f");
  EXPECT_EQ(standby_->query("SELECT pg_is_in_recovery()"), "f");
  primary_->query(kInsert);
  EXPECT_EQ(standby_->query(kCount), "0");
}

TEST_F(PostgresPair, PgBouncerSharesConnectionsAndMoves) {
  if (const string missing = missing_pgbouncer(); !missing.empty())
    GTEST_SKIP() << missing;
  PgBouncer bouncer(*primary_, 1);
  query_postgres(bouncer.url("postgres"), kDurably + kInsert);
  const string process = "SELECT pg_backend_pid()";
  EXPECT_EQ(query_postgres(bouncer.url("postgres"), process),
            query_postgres(bouncer.url("postgres"), process));
  lose_primary(*primary_, *standby_);
  standby_->promote();
  bouncer.move_to(*standby_);
  EXPECT_EQ(query_postgres(bouncer.url("postgres"), kCount), "1");
}

}  // namespace
}  // namespace kinship::test::postgres_cluster_test
