// Followers of distributions, with kinshipd as a process that may be killed.

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::following_test {
namespace {

using std::chrono::seconds;
using Clock = std::chrono::steady_clock;
using Followers = std::vector<std::unique_ptr<link::Follower>>;

constexpr seconds kEnough{250};  // a refit waits ten; the machine may have other work

class Following : public testing::Test {
 protected:
  Following() {
    start_server();
    client_ = make_client("outbox");
    panda_ = register_model("panda");
    ur10e_ = register_model("ur10e");
  }

  void start_server() {
    server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
  }
  std::unique_ptr<link::Client> make_client(const char* outbox) const {
    return std::make_unique<link::Client>(link::ClientOptions{
        .domain = domain_.number(), .outbox = directory_ / outbox, .timeout = seconds(30)});
  }
  Digest register_model(const std::string& name) {
    return client_->register_robot(test::model_description(name)).value_or_throw().robot;
  }
  /// So many sweeps more, durable on return.
  void report(int count) {
    for (int i = 0; i < count; ++i)
      client_->report(test::panda_attempt(panda_, "sweep", seed_++));
    ASSERT_EQ(client_->flush(kEnough).pending, 0U);
  }
  FetchRequest request() const {
    FetchRequest request;
    request.task = "sweep";
    request.robot = ur10e_;
    request.profile = "paper";  // the cheapest fits: every vertex once
    return request;
  }
  ServerStatus status() {
    const AdminReply reply = client_->admin({}).value_or_throw();
    return json::row_from_json<ServerStatus>(reply.rows.at(0)).value_or_throw();
  }
  static std::uint64_t paths_of(const Distribution& distribution) {
    std::uint64_t paths = 0;
    for (const Source& source : distribution.sources)
      paths += source.paths;
    return paths;
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  std::unique_ptr<test::ServerProcess> server_;
  std::unique_ptr<link::Client> client_;
  Digest panda_, ur10e_;
  std::uint64_t seed_ = 0;
};

TEST_F(Following, AFollowerHearsOfTheFirstFitAndOfTheNextAndALateJoinerGetsTheNewest) {
  const auto follower = client_->follow(request());
  EXPECT_EQ(follower->wait_for_newer(nullptr, Clock::now() + seconds(1)), nullptr);
  report(6);
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first) << follower->state().reason;
  EXPECT_GE(paths_of(*first), 1U);  // the six may have come in two batches, a fit between them
  report(12);
  const auto second = follower->wait_for_newer(first, Clock::now() + kEnough);
  ASSERT_NE(second, first) << follower->state().reason;
  EXPECT_GT(second->revision, first->revision);
  EXPECT_GE(paths_of(*second), paths_of(*first) + 5);

  const auto other = make_client("other_outbox");
  const auto late = other->follow(request());
  const auto joined = late->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(joined) << late->state().reason;
  EXPECT_GE(joined->revision, second->revision);
  EXPECT_EQ(joined->id, second->id);
}

TEST_F(Following, AKilledServerIsMissedByNobodyAndFollowedAgainWhenItIsBack) {
  report(6);
  const auto follower = client_->follow(request());
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first) << follower->state().reason;
  server_->kill();
  EXPECT_EQ(follower->newest(), first);
  start_server();
  report(6);
  const auto second = follower->wait_for_newer(first, Clock::now() + kEnough);
  ASSERT_NE(second, first) << follower->state().reason;
  EXPECT_EQ(second->revision, first->revision + 1);
  EXPECT_EQ(second->store_epoch, first->store_epoch);
}

TEST_F(Following, ManyFollowersMakeOneFit) {
  report(6);
  constexpr int kFollowers = 8;
  Followers followers;
  for (int i = 0; i < kFollowers; ++i)
    followers.push_back(client_->follow(request()));
  for (const auto& follower : followers)
    ASSERT_TRUE(follower->wait_for_newer(nullptr, Clock::now() + kEnough));
  EXPECT_EQ(status().fits, 1U);
  EXPECT_EQ(status().followed, 1U);
  const auto first = followers.front()->newest();
  report(6);
  for (const auto& follower : followers)
    EXPECT_NE(follower->wait_for_newer(first, Clock::now() + kEnough)->revision, first->revision);
  EXPECT_EQ(status().fits, 2U);
}

TEST_F(Following, WhereTheLeaseHasLapsedNothingIsFittedBehindAnybodysBack) {
  report(6);
  FetchRequest once = request();
  once.deadline = kEnough;
  once.follow = seconds(2);
  ASSERT_EQ(client_->fetch(once).value_or_throw().status, FetchStatus::Ready);
  const auto deadline = Clock::now() + kEnough;
  while (status().followed > 0 && Clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(status().followed, 0U);
  report(6);
  std::this_thread::sleep_for(seconds(13));  // a follower would have seen a refit by now
  EXPECT_EQ(status().fits, 1U);
}

}  // namespace
}  // namespace kinship::following_test
