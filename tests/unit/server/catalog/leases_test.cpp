#include "server/catalog/leases.hpp"

#include <gtest/gtest.h>

namespace kinship::catalog::leases_test {
namespace {

using std::chrono::seconds;

Digest id(std::uint8_t number) {
  Digest digest;
  digest.bytes[0] = number;
  return digest;
}

fitting::DistributionKey key(const std::string& task) {
  fitting::DistributionKey key;
  key.task = task;
  return key;
}

const Leases::TimePoint kNow(seconds(1000));

TEST(Leases, AreHeldUntilTheyEnd) {
  Leases leases(10);
  leases.take(id(1), key("a"), kNow + seconds(5));
  EXPECT_TRUE(leases.holds(id(1), kNow + seconds(4)));
  EXPECT_FALSE(leases.holds(id(1), kNow + seconds(5)));
  EXPECT_FALSE(leases.holds(id(2), kNow));
  EXPECT_EQ(leases.count(kNow), 1U);
  EXPECT_EQ(leases.count(kNow + seconds(5)), 0U);
}

TEST(Leases, AreExtendedNeverShortened) {
  Leases leases(10);
  leases.take(id(1), key("a"), kNow + seconds(5));
  leases.take(id(1), key("a"), kNow + seconds(9));
  leases.take(id(1), key("a"), kNow + seconds(2));
  leases.expire(kNow + seconds(8));
  EXPECT_TRUE(leases.holds(id(1), kNow + seconds(8)));
  leases.expire(kNow + seconds(9));
  EXPECT_EQ(leases.find(id(1)), nullptr);
}

TEST(Leases, OfTooManyTheOneThatEndsFirstGoesFirst) {
  Leases leases(2);
  leases.take(id(1), key("a"), kNow + seconds(9));
  leases.take(id(2), key("a"), kNow + seconds(5));
  leases.take(id(3), key("a"), kNow + seconds(7));
  EXPECT_TRUE(leases.holds(id(1), kNow));
  EXPECT_FALSE(leases.holds(id(2), kNow));
  EXPECT_TRUE(leases.holds(id(3), kNow));
  EXPECT_EQ(leases.take_ended(), std::vector<Digest>{id(2)});
  EXPECT_TRUE(leases.take_ended().empty());
}

TEST(Leases, OneThatWasTakenAgainHasNotEnded) {
  Leases leases(2);
  leases.take(id(1), key("a"), kNow + seconds(1));
  leases.expire(kNow + seconds(1));
  leases.take(id(1), key("a"), kNow + seconds(9));
  EXPECT_TRUE(leases.take_ended().empty());
}

TEST(Leases, AreFoundByTask) {
  Leases leases(10);
  leases.take(id(1), key("a"), kNow);
  leases.take(id(2), key("b"), kNow);
  leases.take(id(3), key("a"), kNow);
  EXPECT_EQ(leases.of_task("a"), (std::vector<Digest>{id(1), id(3)}));
  leases.end(id(3));
  leases.end(id(3));
  EXPECT_EQ(leases.of_task("a"), std::vector<Digest>{id(1)});
  EXPECT_TRUE(leases.of_task("c").empty());
}

TEST(Leases, KnowWhoIsDue) {
  Leases leases(10);
  for (std::uint8_t i = 1; i < 5; ++i)
    leases.take(id(i), key("a"), kNow + seconds(100));
  EXPECT_FALSE(leases.next_due());
  EXPECT_TRUE(leases.set_due(id(1), kNow + seconds(3)));
  EXPECT_FALSE(leases.set_due(id(1), kNow + seconds(3)));
  EXPECT_FALSE(leases.set_due(id(2), kNow + seconds(4))) << "not earlier than the first";
  EXPECT_TRUE(leases.set_due(id(3), kNow + seconds(2)));
  EXPECT_FALSE(leases.set_due(id(9), kNow)) << "nobody holds it";
  EXPECT_EQ(leases.next_due(), kNow + seconds(2));
  EXPECT_EQ(leases.due(kNow + seconds(3)), (std::vector<Digest>{id(3), id(1)}));
  leases.end(id(3));
  EXPECT_FALSE(leases.set_due(id(1), std::nullopt));
  EXPECT_EQ(leases.next_due(), kNow + seconds(4));
  leases.end_all();
  EXPECT_FALSE(leases.next_due());
  EXPECT_EQ(leases.count(kNow), 0U);
}

TEST(Leases, MayBeForbidden) {
  Leases leases(0);
  leases.take(id(1), key("a"), kNow + seconds(5));
  EXPECT_FALSE(leases.holds(id(1), kNow));
}

TEST(Leases, OfTooManyThoseOfTheClientWithTheMostGo) {
  Leases leases(6);
  for (std::uint8_t i = 1; i <= 2; ++i)
    leases.take(id(i), key("a"), kNow + seconds(60), "robot");
  for (std::uint8_t i = 10; i < 30; ++i)
    EXPECT_TRUE(leases.take(id(i), key("a"), kNow + seconds(86'400 + i), "greedy"));
  EXPECT_EQ(leases.holds(), 6U);
  EXPECT_TRUE(leases.holds(id(1), kNow) && leases.holds(id(2), kNow));
  EXPECT_TRUE(leases.holds(id(29), kNow) && leases.holds(id(26), kNow));
  EXPECT_FALSE(leases.holds(id(25), kNow)) << "its own that end first make room";
}

TEST(Leases, EveryHolderKeepsALeaseForAsLongAsItAskedFor) {
  Leases leases(3);
  leases.take(id(1), key("a"), kNow + seconds(60), "robot");
  leases.take(id(1), key("a"), kNow + seconds(600), "greedy");
  leases.take(id(2), key("a"), kNow + seconds(600), "greedy");
  leases.take(id(3), key("a"), kNow + seconds(700), "greedy");  // its hold on 1 or 2 goes
  EXPECT_TRUE(leases.holds(id(1), kNow + seconds(59)));
  leases.expire(kNow + seconds(60));
  EXPECT_EQ(leases.count(kNow + seconds(60)), 2U);
  leases.end(id(3));
  leases.expire(kNow + seconds(600));
  EXPECT_EQ(leases.holds(), 0U);
  EXPECT_EQ(leases.of_task("a"), std::vector<Digest>{});
}

TEST(Leases, AClientHasItsLimitAndMayExtendWhatItHas) {
  Leases leases(10, 2);
  EXPECT_TRUE(leases.take(id(1), key("a"), kNow + seconds(5), "one"));
  EXPECT_TRUE(leases.take(id(2), key("a"), kNow + seconds(5), "one"));
  EXPECT_FALSE(leases.take(id(3), key("a"), kNow + seconds(5), "one"));
  EXPECT_TRUE(leases.take(id(1), key("a"), kNow + seconds(9), "one"));
  EXPECT_TRUE(leases.take(id(3), key("a"), kNow + seconds(5), "two"));
  EXPECT_EQ(leases.find(id(1))->until, kNow + seconds(9));
  EXPECT_EQ(leases.take_ended(), std::vector<Digest>{});
}

}  // namespace
}  // namespace kinship::catalog::leases_test
