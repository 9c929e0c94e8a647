// Followers against a server in this process, over loopback.

#include "client/link/follower.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <optional>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/unit/client/link/follow_server.hpp"

namespace kinship::link::follower_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kEnough = 60s;  // on a machine that does other things
constexpr std::uint64_t kSeed = 41;

class FollowerTest : public testing::Test {
 protected:
  FollowerTest() {
    distribution_.task = "shelf_pick";
    distribution_.robot = values_.digest();
    distribution_.revision = 7;
    distribution_.state = DistributionState::Ready;
    distribution_.reason.clear();
    if (!distribution_.mixture)
      distribution_.mixture = values_.mixture(distribution_.limits.cols());
  }
  Client client() const {
    return Client({.domain = domain_.number(), .outbox = {}, .has_outbox = false, .timeout = 5s});
  }
  FetchRequest request() const {
    FetchRequest request;
    request.task = distribution_.task;
    request.robot = distribution_.robot;
    return request;
  }
  FetchReply ready() const {
    FetchReply reply;
    reply.status = FetchStatus::Ready;
    reply.distribution = distribution_;
    return reply;
  }
  static FetchReply status(FetchStatus status, const std::string& message = "") {
    FetchReply reply;
    reply.status = status;
    reply.message = message;
    return reply;
  }
  /// Waits for it. \return whether it came.
  static bool becomes(const Follower& follower, FollowStatus status) {
    const auto deadline = Clock::now() + kEnough;
    while (follower.state().status != status && Clock::now() < deadline)
      std::this_thread::sleep_for(10ms);
    return follower.state().status == status;
  }

  test::ReservedDomain domain_;
  test::RandomValues values_{kSeed};
  Distribution distribution_ = values_.distribution();
};

TEST_F(FollowerTest, HoldsWhatTheServerHasUnderALeaseOfAMinute) {
  FollowServer server(domain_.number(), ready());
  const auto follower = client().follow(request());
  const auto newest = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->revision, 7U);
  EXPECT_EQ(follower->newest(), newest);
  EXPECT_TRUE(becomes(*follower, FollowStatus::Ready));
  EXPECT_EQ(server.last_request().follow, 60s);
}

TEST_F(FollowerTest, AsksWhereTheRobotStandsBeforeItFetches) {
  Attempt attempt = values_.attempt(5);
  attempt.T_task_base = values_.pose();
  FollowServer server(domain_.number(), ready(), [&](const AdminRequest& wanted) {
    AdminReply reply;
    reply.status = AdminStatus::Ok;
    AttemptSummary summary;
    summary.report_uuid = attempt.report_uuid;
    summary.robot = distribution_.robot;
    reply.rows.push_back(wanted.verb == AdminVerb::FindAttempts ? json::to_json(summary)
                                                                : json::to_json(attempt));
    return reply;
  });
  const auto follower = client().follow(request(), {.asks_placement = true});
  ASSERT_TRUE(follower->wait_for_newer(nullptr, Clock::now() + kEnough));
  const auto told = follower->T_task_base();
  ASSERT_TRUE(told);
  EXPECT_TRUE(told->isApprox(*attempt.T_task_base));
  EXPECT_TRUE(server.first_request().T_task_base.value().isApprox(*told));
}

TEST_F(FollowerTest, AsksAgainWhereARobotStandsThatHasNotReportedYet) {
  Attempt attempt = values_.attempt(5);
  attempt.T_task_base = values_.pose();
  std::atomic<bool> has_reported = false;
  FollowServer server(domain_.number(), status(FetchStatus::NoExperience),
                      [&](const AdminRequest& wanted) {
                        AdminReply reply;
                        reply.status = AdminStatus::Ok;
                        AttemptSummary summary;
                        summary.report_uuid = attempt.report_uuid;
                        summary.robot = distribution_.robot;
                        if (wanted.verb == AdminVerb::ShowPath)
                          reply.rows.push_back(json::to_json(attempt));
                        else if (has_reported.exchange(true))
                          reply.rows.push_back(json::to_json(summary));
                        return reply;
                      });
  const auto follower =
      client().follow(request(), {.longest_pause = 200ms, .asks_placement = true});
  ASSERT_TRUE(server.wait_for_fetches(2, kEnough));
  EXPECT_FALSE(server.first_request().T_task_base);
  ASSERT_TRUE(server.last_request().T_task_base);
  EXPECT_TRUE(server.last_request().T_task_base->isApprox(*attempt.T_task_base));
  EXPECT_TRUE(follower->T_task_base().value().isApprox(*attempt.T_task_base));
}

TEST_F(FollowerTest, FetchesForNoPlacementThatItIsNotTold) {
  const FollowServer server(domain_.number(), ready(), [](const AdminRequest&) {
    AdminReply reply;
    reply.status = AdminStatus::Refused;
    reply.message = "of role reader";
    return reply;
  });
  const auto follower = client().follow(request(), {.asks_placement = true});
  ASSERT_TRUE(becomes(*follower, FollowStatus::Refused));
  EXPECT_NE(follower->state().reason.find("no T_task_base is given"), std::string::npos);
  EXPECT_NE(follower->state().reason.find("of role reader"), std::string::npos);
  EXPECT_EQ(server.fetches(), 0);
}

TEST_F(FollowerTest, FetchesWhatIsAnnouncedAndKeepsWhatItGaveOut) {
  FollowServer server(domain_.number(), ready());
  const auto follower = client().follow(request());
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first);
  distribution_.revision = 8;
  server.set_reply(ready());
  server.announce(distribution_);
  const auto second = follower->wait_for_newer(first, Clock::now() + kEnough);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->revision, 8U);
  EXPECT_EQ(first->revision, 7U);
}

TEST_F(FollowerTest, HoldsPathsToRecallAndAsksOnlyForOthers) {
  FetchReply reply = ready();
  reply.recall = values_.recall_library(3);
  FollowServer server(domain_.number(), reply);
  const auto follower = client().follow(request());
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first);
  const auto held = follower->recall();
  ASSERT_TRUE(held);
  EXPECT_EQ(held->revision, reply.recall->revision);
  EXPECT_EQ(held->paths.size(), reply.recall->paths.size());
  EXPECT_EQ(server.first_request().known_recall, 0U);

  distribution_.revision = 8;
  server.set_reply(ready());  // without it, as nothing changed
  server.announce(distribution_);
  const auto second = follower->wait_for_newer(first, Clock::now() + kEnough);
  ASSERT_TRUE(second);
  EXPECT_EQ(server.last_request().known_recall, held->revision);
  EXPECT_EQ(follower->recall(), held);

  distribution_.revision = 9;
  reply = ready();
  reply.recall = values_.recall_library(3);
  server.set_reply(reply);
  server.announce(distribution_);
  ASSERT_TRUE(follower->wait_for_newer(second, Clock::now() + kEnough));
  EXPECT_EQ(follower->recall()->revision, reply.recall->revision);
}

TEST_F(FollowerTest, ALowerRevisionOfAnotherStoreEpochIsNews) {
  FollowServer server(domain_.number(), ready());
  const auto follower = client().follow(request());
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first);
  distribution_.revision = 1;
  distribution_.store_epoch = Uuid::random();
  server.set_reply(ready());
  server.announce(distribution_);
  const auto second = follower->wait_for_newer(first, Clock::now() + kEnough);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->revision, 1U);
}

TEST_F(FollowerTest, AnnouncementsOfOthersAndOfWhatItHasAreNoReasonToFetch) {
  FollowServer server(domain_.number(), ready());
  const auto follower = client().follow(request());
  ASSERT_TRUE(follower->wait_for_newer(nullptr, Clock::now() + kEnough));
  ASSERT_TRUE(becomes(*follower, FollowStatus::Ready));
  const int before = server.fetches();
  Distribution other = distribution_;  // the same robot at another place
  other.id = values_.digest();
  other.revision = 99;
  server.announce(other);
  server.announce(distribution_);
  std::this_thread::sleep_for(500ms);  // nothing is to happen: there is no event to wait for
  const int after = server.fetches();
  EXPECT_LE(after, before + 1);  // its first sight of the server may count as one
  distribution_.revision = 8;    // but this is one, and comes after the others
  server.set_reply(ready());
  server.announce(distribution_);
  EXPECT_TRUE(server.wait_for_fetches(after + 1, kEnough));
}

TEST_F(FollowerTest, RenewsItsLeaseAtAThird) {
  FollowServer server(domain_.number(), ready());
  FetchRequest wanted = request();
  wanted.follow = 3s;
  const auto follower = client().follow(wanted);
  EXPECT_TRUE(server.wait_for_fetches(4, kEnough));
  EXPECT_EQ(server.last_request().follow, 3s);
}

TEST_F(FollowerTest, WithoutExperienceItSaysWhyAndHearsOfTheFirstFit) {
  FollowServer server(domain_.number(),
                      status(FetchStatus::NoExperience, "no paths of task 'shelf_pick'"));
  // So long a pause that only the announcement can end it.
  const auto follower = client().follow(request(), {.longest_pause = 10min});
  ASSERT_TRUE(becomes(*follower, FollowStatus::NoExperience));
  EXPECT_EQ(follower->newest(), nullptr);
  EXPECT_EQ(follower->state().reason, "no paths of task 'shelf_pick'");
  server.set_reply(ready());
  server.announce(distribution_);
  EXPECT_TRUE(follower->wait_for_newer(nullptr, Clock::now() + 15s));
}

TEST_F(FollowerTest, WithoutExperienceItAsksAgain) {
  FollowServer server(domain_.number(), status(FetchStatus::NoExperience));
  const auto follower = client().follow(request(), {.longest_pause = 400ms});
  ASSERT_TRUE(server.wait_for_fetches(5, kEnough));
  server.set_reply(ready());  // and nobody announces it
  EXPECT_TRUE(follower->wait_for_newer(nullptr, Clock::now() + kEnough));
}

TEST_F(FollowerTest, WhatTheServerNoLongerStandsForIsDropped) {
  FollowServer server(domain_.number(), ready());
  FetchRequest wanted = request();
  wanted.follow = 2s;
  const auto follower = client().follow(wanted, {.longest_pause = 100ms});
  ASSERT_TRUE(follower->wait_for_newer(nullptr, Clock::now() + kEnough));
  server.set_reply(status(FetchStatus::NoExperience));  // all of it was retired
  ASSERT_TRUE(becomes(*follower, FollowStatus::NoExperience));
  EXPECT_EQ(follower->newest(), nullptr);
}

TEST_F(FollowerTest, KeepsWhatItHasWhileNobodyAnswersAndFindsTheNextServer) {
  std::optional<FollowServer> server(std::in_place, domain_.number(), ready());
  const auto follower = client().follow(request());
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first);
  server.reset();
  const auto kept = follower->newest();  // maybe fetched again meanwhile
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->revision, first->revision);
  distribution_.revision = 8;
  server.emplace(domain_.number(), ready());  // announces nothing
  const auto second = follower->wait_for_newer(kept, Clock::now() + 15s);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->revision, 8U);
}

TEST_F(FollowerTest, WithoutAServerItSaysSoAndEndsAtOnce) {
  auto follower = client().follow(request());
  EXPECT_EQ(follower->state().status, FollowStatus::NoServer);
  EXPECT_NE(follower->state().reason.find("domain " + std::to_string(domain_.number())),
            std::string::npos);
  EXPECT_EQ(follower->wait_for_newer(nullptr, Clock::now() + 50ms), nullptr);
  const auto start = Clock::now();
  follower.reset();
  EXPECT_LT(Clock::now() - start, 5s);  // a fetch under way would take 12 s
}

TEST_F(FollowerTest, ARequestThatBreaksARuleIsRefusedAtOnce) {
  FetchRequest wanted = request();
  wanted.task = "two words";
  EXPECT_THROW(client().follow(wanted), Failure);
}

}  // namespace
}  // namespace kinship::link::follower_test
