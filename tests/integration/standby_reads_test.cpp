// A kinshipd over a primary and a standby: its fits read the standby, and have what they claim also
// while that one is behind.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/support/cell.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::standby_reads_test {
namespace {

class StandbyReads : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    primary_ = std::make_unique<test::PostgresCluster>();
    primary_->create_database("kinship");
    standby_ = std::make_unique<test::PostgresCluster>(
        *primary_, test::PostgresCluster::Options{.name = "standby"});
    cell_ = std::make_unique<test::Cell>(
        test::Cell::Options{.folder = folder_.path() / "cell",
                            .store = test::url_of_either(*primary_, *standby_, "kinship")});
    cell_->start();
    panda_ = cell_->register_model("panda").robot;
  }
  /// A fit of today's generation. \return of its paths, those that it used.
  std::uint64_t paths_of_a_fit() {
    const std::string generation =
        primary_->query("SELECT max(generation) FROM experience", "kinship");
    const FetchReply reply = cell_->fetch(panda_, std::stoull(generation));
    if (!reply.distribution || reply.distribution->sources.size() != 1) {
      ADD_FAILURE() << reply.message;
      return 0;
    }
    const Source& source = reply.distribution->sources.front();
    EXPECT_GE(source.generation, std::stoull(generation));
    EXPECT_EQ(source.paths, source.paths_used);
    return source.paths_used;
  }
  ReplicaUse use_of_standby() const {
    for (const ReplicaUse& use : cell_->status().replicas)
      if (use.host.find(standby_->folder()) != std::string::npos)
        return use;
    ADD_FAILURE() << "no host " << standby_->folder();
    return {};
  }

  const test::TemporaryDirectory folder_;
  std::unique_ptr<test::PostgresCluster> primary_, standby_;
  std::unique_ptr<test::Cell> cell_;
  Digest panda_;
};

TEST_F(StandbyReads, AFitReadsTheStandbyAndHasWhatItClaimsAlsoWhileThatOneIsBehind) {
  cell_->report(panda_, 1, 8);
  test::wait_until_replayed(*primary_, *standby_);
  EXPECT_EQ(paths_of_a_fit(), 8U);
  const ReplicaUse before = use_of_standby();
  EXPECT_GT(before.readings, 0U) << before.message;
  EXPECT_EQ(before.failed, 0U) << before.message;

  standby_->query("SELECT pg_wal_replay_pause()");
  test::wait_until_true(standby_->url(), "SELECT pg_get_wal_replay_pause_state() = 'paused'");
  const Uuid last = cell_->report(panda_, 9, 4).back();
  EXPECT_EQ(paths_of_a_fit(), 12U);
  EXPECT_EQ(cell_->ask(AdminVerb::RetirePath, last.text()).status, AdminStatus::Ok);
  EXPECT_EQ(paths_of_a_fit(), 11U);
  EXPECT_GT(use_of_standby().behind, before.behind);
  EXPECT_EQ(use_of_standby().failed, 0U) << use_of_standby().message;

  standby_->kill();
  cell_->report(panda_, 13, 4);
  EXPECT_EQ(paths_of_a_fit(), 15U) << "a standby that is gone costs no fit";
}

}  // namespace
}  // namespace kinship::standby_reads_test
