#include "server/quotas/client_quotas.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "server/quotas/known_tasks.hpp"
#include "server/quotas/token_bucket.hpp"

namespace kinship::quotas::quotas_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class Book : public testing::Test {
 protected:
  ClientRates rates_{.attempts_per_s = 10,
                     .bytes_per_s = 1000,
                     .robots_per_day = 2,
                     .tasks_per_day = 3,
                     .stored_bytes_per_day = 86'400,
                     .max_clients = 3};
  std::chrono::steady_clock::time_point now_{seconds(1000)};
  runtime::Clock clock_{[this] { return now_; }, [] { return std::int64_t{1234}; }};

  static ClientUse use_of(const ClientQuotas& quotas, std::string_view client) {
    for (const ClientUse& use : quotas.list())
      if (use.client == client)
        return use;
    return {};
  }
};

TEST_F(Book, AGreedyClientIsToldWhenToComeAgainAndItsNeighbourIsNotConcerned) {
  ClientQuotas quotas(clock_, rates_);
  EXPECT_FALSE(quotas.admit("greedy", 0, 100));
  const auto refusal = quotas.admit("greedy", 0, 5);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->quota, Quota::Attempts);
  EXPECT_EQ(refusal->retry_after, milliseconds(500));
  EXPECT_EQ(refusal->message,
            "busy: client 'greedy' is over its quota of 10 attempts a second (kinshipd "
            "--client-attempts-per-s); again in 0.5 s");
  EXPECT_FALSE(quotas.admit("polite", 0, 5));
  now_ += refusal->retry_after;
  EXPECT_FALSE(quotas.admit("greedy", 0, 5)) << "it came when it was told to";
  EXPECT_TRUE(quotas.admit("greedy", 0, 5));
  EXPECT_EQ(use_of(quotas, "greedy").refused, 2U);
  EXPECT_EQ(use_of(quotas, "greedy").refused_for, "attempts");
  EXPECT_EQ(use_of(quotas, "greedy").attempts, 105U) << "what was refused is not among them";
  EXPECT_EQ(use_of(quotas, "polite").refused, 0U);
  EXPECT_EQ(quotas.refusals(Quota::Attempts), 2U);
}

TEST_F(Book, WhatWasSentCountsAfterwards) {
  ClientQuotas quotas(clock_, rates_);
  EXPECT_FALSE(quotas.admit("reader", 100, 0));
  quotas.count_reply("reader", 30'000);
  const auto refusal = quotas.admit("reader", 100, 0);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->quota, Quota::Bytes);
  EXPECT_EQ(refusal->retry_after, milliseconds(20'200)) << "30 100 of 10 000 were taken";
  quotas.count_reply("reader", 1'000'000'000);
  EXPECT_EQ(quotas.admit("reader", 100, 0)->retry_after, seconds(60)) << "no longer than that";
}

TEST_F(Book, RobotsTasksAndStoredPathsCountByTheDay) {
  ClientQuotas quotas(clock_, rates_);
  for (const std::string label : {"a", "b"}) {
    EXPECT_FALSE(quotas.may_add("client", Quota::Robots));
    quotas.count_robot("client", label, true);
  }
  quotas.count_robot("client", "a", false);
  EXPECT_TRUE(quotas.may_add("client", Quota::Robots));
  EXPECT_FALSE(quotas.may_add("client", Quota::Tasks));
  for (int i = 0; i < 3; ++i)
    quotas.count_task("client");
  EXPECT_TRUE(quotas.may_add("client", Quota::Tasks));
  quotas.count_stored("client", 90'000);
  const auto refusal = quotas.admit("client", 0, 1);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->quota, Quota::Stored);
  EXPECT_NE(refusal->message.find("0.0864 MB of paths a day"), std::string::npos)
      << refusal->message;
  EXPECT_FALSE(quotas.admit("client", 0, 0)) << "it may fetch";
  const ClientUse use = use_of(quotas, "client");
  EXPECT_EQ(use.robots, (std::vector<std::string>{"b", "a"})) << "the newest last, each once";
  EXPECT_EQ(use.registered_robots, 2U);
  EXPECT_EQ(use.created_tasks, 3U);
  EXPECT_EQ(use.stored_bytes, 90'000U);
  now_ += std::chrono::hours(24);
  EXPECT_FALSE(quotas.may_add("client", Quota::Robots));
  EXPECT_FALSE(quotas.admit("client", 0, 1));
}

TEST_F(Book, InventedIdentitiesShareOneClientsQuotasAndCostNoMemory) {
  ClientQuotas quotas(clock_, rates_);
  for (const std::string client : {"one", "two", "three"})
    EXPECT_FALSE(quotas.admit(client, 0, 1));
  int let_in = 0;
  for (int i = 0; i < 10'000; ++i)
    let_in += quotas.admit("invented " + std::to_string(i), 0, 1) ? 0 : 1;
  EXPECT_EQ(let_in, 100) << "the burst of one client";
  EXPECT_EQ(quotas.size(), 4U);
  EXPECT_EQ(use_of(quotas, ClientQuotas::kOthers).refused, 9'900U);
  EXPECT_FALSE(quotas.admit("two", 0, 99)) << "who was there keeps its own";
}

TEST_F(Book, WhoIsIdleMakesRoomUnlessThatGaveAwayAQuota) {
  ClientQuotas quotas(clock_, rates_);
  EXPECT_FALSE(quotas.admit("owes", 0, 1));
  quotas.count_robot("owes", "r", true);
  for (const std::string client : {"idle", "busy"})
    EXPECT_FALSE(quotas.admit(client, 0, 1));
  now_ += ClientQuotas::kIdle;
  EXPECT_FALSE(quotas.admit("busy", 0, 1));
  EXPECT_FALSE(quotas.admit("new", 0, 1));
  EXPECT_EQ(quotas.size(), 3U);
  EXPECT_EQ(use_of(quotas, "new").attempts, 1U);
  EXPECT_EQ(use_of(quotas, "idle").client, "") << "it was forgotten";
  EXPECT_EQ(use_of(quotas, "owes").registered_robots, 1U) << "its day is not over";
}

TEST_F(Book, ListsWhoTakesMostFirst) {
  ClientQuotas quotas(clock_, rates_);
  EXPECT_FALSE(quotas.admit("much", 9000, 60));
  now_ += seconds(1);
  EXPECT_FALSE(quotas.admit("little", 10, 6));
  const std::vector<ClientUse> rows = quotas.list();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].client, "much");
  EXPECT_NEAR(rows[0].attempts_per_s, 1, 0.02) << "60 a second ago, over a minute";
  EXPECT_NEAR(rows[1].bytes_per_s, 10.0 / 60, 1e-9);
  EXPECT_EQ(rows[1].last_seen_ms, 1234);
  now_ += seconds(600);
  EXPECT_LT(quotas.list()[0].attempts_per_s, 0.001);
}

TEST_F(Book, ZeroIsNoLimitAndNobodyInParticularHasNone) {
  ClientQuotas quotas(clock_, {.attempts_per_s = 0,
                               .bytes_per_s = 0,
                               .robots_per_day = 0,
                               .tasks_per_day = 0,
                               .stored_bytes_per_day = 0});
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(quotas.admit("client", 1'000'000'000, 1'000'000));
  ClientQuotas limited(clock_, rates_);
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(limited.admit("", 1'000'000'000, 1'000'000));
  EXPECT_EQ(limited.size(), 0U);
}

class Bucket : public testing::Test {
 protected:
  double time_until(double amount) { return bucket_.time_until(rate_, amount, now_).count(); }
  void take(double amount) { bucket_.take(rate_, amount, now_); }

  Rate rate_{.per_s = 2, .burst = 10};
  TokenBucket::TimePoint now_{seconds(1000)};
  TokenBucket bucket_{rate_, now_};
};

TEST_F(Bucket, GivesABurstAndThenAsMuchAsComesIn) {
  EXPECT_EQ(time_until(10), 0);
  take(10);
  EXPECT_DOUBLE_EQ(time_until(1), 0.5);
  now_ += seconds(3);
  EXPECT_EQ(time_until(6), 0);
  EXPECT_DOUBLE_EQ(time_until(8), 1);
  now_ += seconds(1000);
  EXPECT_EQ(time_until(10), 0);
  take(10);
  EXPECT_GT(time_until(1), 0) << "it holds no more than a burst, however long nothing was taken";
}

TEST_F(Bucket, MoreThanItHoldsIsTakenWhenItIsFullAndOwedThen) {
  EXPECT_EQ(time_until(30), 0);
  take(30);
  EXPECT_DOUBLE_EQ(time_until(10), 15) << "20 owed and 10 missing, 2 a second";
  now_ += seconds(15);
  EXPECT_TRUE(bucket_.is_full(rate_, now_));
}

TEST_F(Bucket, AClockThatGoesBackGivesNothing) {
  take(10);
  now_ -= seconds(100);
  EXPECT_DOUBLE_EQ(time_until(1), 0.5);
}

TEST_F(Bucket, WithoutABurstThereIsNoLimit) {
  rate_ = {};
  take(1e12);
  EXPECT_EQ(time_until(1e12), 0);
  EXPECT_TRUE(bucket_.is_full(rate_, now_)) << "a client without limits may be forgotten";
}

TEST(KnownTasks, TellsWhatIsNewAndIsBounded) {
  KnownTasks tasks(2);
  EXPECT_TRUE(tasks.add("shelf"));
  EXPECT_FALSE(tasks.add("shelf"));
  EXPECT_TRUE(tasks.add("bin"));
  EXPECT_TRUE(tasks.has("shelf") && tasks.has("bin"));
  EXPECT_TRUE(tasks.add("table"));
  EXPECT_TRUE(tasks.has("table"));
  EXPECT_FALSE(tasks.has("shelf")) << "the store is asked again";
}

}  // namespace
}  // namespace kinship::quotas::quotas_test
