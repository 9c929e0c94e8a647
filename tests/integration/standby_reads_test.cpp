// A kinshipd over a primary and a standby: its fits read the standby, and have what they claim also
// while that one is behind.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "proto/json/summaries_json.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/postgres_query.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::standby_reads_test {
namespace {

using std::chrono::seconds;

constexpr seconds kEnough{60};  // the machine may have other work

class StandbyReads : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    primary_ = std::make_unique<test::PostgresCluster>();
    primary_->create_database("kinship");
    standby_ = std::make_unique<test::PostgresCluster>(
        *primary_, test::PostgresCluster::Options{.name = "standby"});
    server_ = std::make_unique<test::Program>(
        "kinshipd",
        std::vector<std::string>{"--store", test::url_of_either(*primary_, *standby_, "kinship"),
                                 "--domain", std::to_string(domain_.number())},
        folder_.path() / "log");
    ASSERT_TRUE(server_->read_line().starts_with("ready "));
    client_ = std::make_unique<link::Client>(link::ClientOptions{
        .domain = domain_.number(), .outbox = folder_.path() / "outbox", .timeout = kEnough});
    panda_ = client_->register_robot(test::model_description("panda")).value_or_throw().robot;
    ur10e_ = client_->register_robot(test::model_description("ur10e")).value_or_throw().robot;
  }
  Uuid report(std::uint64_t first, std::uint64_t count) const {
    Uuid last;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Attempt attempt = test::panda_attempt(panda_, "sweep", first + i);
      last = attempt.report_uuid;
      client_->report(attempt);
    }
    EXPECT_EQ(client_->flush(kEnough).pending, 0U);
    return last;
  }
  FetchReply fetch() const {
    FetchRequest request;
    request.task = "sweep";
    request.robot = ur10e_;
    request.profile = "paper";  // the cheapest fits
    request.deadline = kEnough;
    return client_->fetch(request).value_or_throw();
  }
  /// Fetches until a fit has so many paths. \return whether one had.
  bool has_paths(std::uint64_t paths) const {
    for (const auto end = std::chrono::steady_clock::now() + kEnough;
         std::chrono::steady_clock::now() < end;
         std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
      const FetchReply reply = fetch();
      if (reply.distribution && reply.distribution->sources.at(0).paths == paths)
        return true;
    }
    return false;
  }
  ReplicaUse use_of_standby() const {
    const AdminReply reply = client_->admin({}).value_or_throw();
    for (const ReplicaUse& use :
         json::server_status_from_json(reply.rows.at(0)).value_or_throw().replicas)
      if (use.host.find(standby_->folder()) != std::string::npos)
        return use;
    ADD_FAILURE() << reply.rows.at(0);
    return {};
  }

  const test::TemporaryDirectory folder_;
  const test::ReservedDomain domain_;
  std::unique_ptr<test::PostgresCluster> primary_, standby_;
  std::unique_ptr<test::Program> server_;
  std::unique_ptr<link::Client> client_;
  Digest panda_, ur10e_;
};

TEST_F(StandbyReads, AFitReadsTheStandbyAndHasWhatItClaimsAlsoWhileThatOneIsBehind) {
  report(1, 8);
  test::wait_until_replayed(*primary_, *standby_);
  const FetchReply made = fetch();
  ASSERT_EQ(made.status, FetchStatus::Ready) << made.message;
  EXPECT_EQ(made.distribution->sources.at(0).paths, 8U);
  const ReplicaUse before = use_of_standby();
  EXPECT_GT(before.readings, 0U) << before.message;
  EXPECT_EQ(before.failed, 0U) << before.message;

  standby_->query("SELECT pg_wal_replay_pause()");
  test::wait_until_true(standby_->url(), "SELECT pg_get_wal_replay_pause_state() = 'paused'");
  const Uuid last = report(9, 4);
  EXPECT_TRUE(has_paths(12));
  AdminRequest retirement;
  retirement.verb = AdminVerb::RetirePath;
  retirement.argument = last.text();
  EXPECT_EQ(client_->admin(retirement).value_or_throw().status, AdminStatus::Ok);
  EXPECT_TRUE(has_paths(11));
  EXPECT_GT(use_of_standby().behind, before.behind);
  EXPECT_EQ(use_of_standby().failed, 0U) << use_of_standby().message;

  standby_->kill();
  report(13, 4);
  EXPECT_TRUE(has_paths(15)) << "a standby that is gone costs no fit";
}

}  // namespace
}  // namespace kinship::standby_reads_test
