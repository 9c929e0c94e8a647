#include "server/quotas/client_book.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace kinship::quotas::client_book_test {
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

  static ClientUse use_of(const ClientBook& book, std::string_view client) {
    for (const ClientUse& use : book.list())
      if (use.client == client)
        return use;
    return {};
  }
};

TEST_F(Book, AGreedyClientIsToldWhenToComeAgainAndItsNeighbourIsNotConcerned) {
  ClientBook book(clock_, rates_);
  EXPECT_FALSE(book.admit("greedy", 0, 100));
  const auto refusal = book.admit("greedy", 0, 5);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->quota, Quota::Attempts);
  EXPECT_EQ(refusal->retry_after, milliseconds(500));
  EXPECT_EQ(refusal->message,
            "busy: client 'greedy' is over its quota of 10 attempts a second (kinshipd "
            "--client-attempts-per-s); again in 0.5 s");
  EXPECT_FALSE(book.admit("polite", 0, 5));
  now_ += refusal->retry_after;
  EXPECT_FALSE(book.admit("greedy", 0, 5)) << "it came when it was told to";
  EXPECT_TRUE(book.admit("greedy", 0, 5));
  EXPECT_EQ(use_of(book, "greedy").refused, 2U);
  EXPECT_EQ(use_of(book, "greedy").refused_for, "attempts");
  EXPECT_EQ(use_of(book, "greedy").attempts, 105U) << "what was refused is not among them";
  EXPECT_EQ(use_of(book, "polite").refused, 0U);
  EXPECT_EQ(book.refusals(Quota::Attempts), 2U);
}

TEST_F(Book, WhatWasSentCountsAfterwards) {
  ClientBook book(clock_, rates_);
  EXPECT_FALSE(book.admit("reader", 100, 0));
  book.count_reply("reader", 30'000);
  const auto refusal = book.admit("reader", 100, 0);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->quota, Quota::Bytes);
  EXPECT_EQ(refusal->retry_after, milliseconds(20'200)) << "30 100 of 10 000 were taken";
  book.count_reply("reader", 1'000'000'000);
  EXPECT_EQ(book.admit("reader", 100, 0)->retry_after, seconds(60)) << "no longer than that";
}

TEST_F(Book, RobotsTasksAndStoredPathsCountByTheDay) {
  ClientBook book(clock_, rates_);
  for (const std::string label : {"a", "b"}) {
    EXPECT_FALSE(book.may_add("client", Quota::Robots));
    book.count_robot("client", label, true);
  }
  book.count_robot("client", "a", false);
  EXPECT_TRUE(book.may_add("client", Quota::Robots));
  EXPECT_FALSE(book.may_add("client", Quota::Tasks));
  for (int i = 0; i < 3; ++i)
    book.count_task("client");
  EXPECT_TRUE(book.may_add("client", Quota::Tasks));
  book.count_stored("client", 90'000);
  const auto refusal = book.admit("client", 0, 1);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->quota, Quota::Stored);
  EXPECT_NE(refusal->message.find("0.0864 MB of paths a day"), std::string::npos)
      << refusal->message;
  EXPECT_FALSE(book.admit("client", 0, 0)) << "it may fetch";
  const ClientUse use = use_of(book, "client");
  EXPECT_EQ(use.robots, (std::vector<std::string>{"b", "a"})) << "the newest last, each once";
  EXPECT_EQ(use.registered_robots, 2U);
  EXPECT_EQ(use.created_tasks, 3U);
  EXPECT_EQ(use.stored_bytes, 90'000U);
  now_ += std::chrono::hours(24);
  EXPECT_FALSE(book.may_add("client", Quota::Robots));
  EXPECT_FALSE(book.admit("client", 0, 1));
}

TEST_F(Book, InventedIdentitiesShareOneClientsQuotasAndCostNoMemory) {
  ClientBook book(clock_, rates_);
  for (const std::string client : {"one", "two", "three"})
    EXPECT_FALSE(book.admit(client, 0, 1));
  int let_in = 0;
  for (int i = 0; i < 10'000; ++i)
    let_in += book.admit("invented " + std::to_string(i), 0, 1) ? 0 : 1;
  EXPECT_EQ(let_in, 100) << "the burst of one client";
  EXPECT_EQ(book.size(), 4U);
  EXPECT_EQ(use_of(book, ClientBook::kOthers).refused, 9'900U);
  EXPECT_FALSE(book.admit("two", 0, 99)) << "who was there keeps its own";
}

TEST_F(Book, WhoIsIdleMakesRoomUnlessThatGaveAwayAQuota) {
  ClientBook book(clock_, rates_);
  EXPECT_FALSE(book.admit("owes", 0, 1));
  book.count_robot("owes", "r", true);
  for (const std::string client : {"idle", "busy"})
    EXPECT_FALSE(book.admit(client, 0, 1));
  now_ += ClientBook::kIdle;
  EXPECT_FALSE(book.admit("busy", 0, 1));
  EXPECT_FALSE(book.admit("new", 0, 1));
  EXPECT_EQ(book.size(), 3U);
  EXPECT_EQ(use_of(book, "new").attempts, 1U);
  EXPECT_EQ(use_of(book, "idle").client, "") << "it was forgotten";
  EXPECT_EQ(use_of(book, "owes").registered_robots, 1U) << "its day is not over";
}

TEST_F(Book, ListsWhoTakesMostFirst) {
  ClientBook book(clock_, rates_);
  EXPECT_FALSE(book.admit("much", 9000, 60));
  now_ += seconds(1);
  EXPECT_FALSE(book.admit("little", 10, 6));
  const std::vector<ClientUse> rows = book.list();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].client, "much");
  EXPECT_NEAR(rows[0].attempts_per_s, 1, 0.02) << "60 a second ago, over a minute";
  EXPECT_NEAR(rows[1].bytes_per_s, 10.0 / 60, 1e-9);
  EXPECT_EQ(rows[1].last_seen_ms, 1234);
  now_ += seconds(600);
  EXPECT_LT(book.list()[0].attempts_per_s, 0.001);
}

TEST_F(Book, ZeroIsNoLimitAndNobodyInParticularHasNone) {
  ClientBook book(clock_, {.attempts_per_s = 0,
                           .bytes_per_s = 0,
                           .robots_per_day = 0,
                           .tasks_per_day = 0,
                           .stored_bytes_per_day = 0});
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(book.admit("client", 1'000'000'000, 1'000'000));
  ClientBook limited(clock_, rates_);
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(limited.admit("", 1'000'000'000, 1'000'000));
  EXPECT_EQ(limited.size(), 0U);
}

}  // namespace
}  // namespace kinship::quotas::client_book_test
