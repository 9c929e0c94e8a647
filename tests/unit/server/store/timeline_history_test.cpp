#include "server/store/sqlite/opening/timeline_history.hpp"

#include <gtest/gtest.h>

#include "server/store/values/consistency_token.hpp"

namespace kinship::store::timeline_history_test {
namespace {

const Uuid kEpoch = Uuid::random();

TEST(TimelineHistory, ContainsWhatEachRunWroteAndNothingBehindIt) {
  TimelineHistory log(kEpoch);
  const Uuid first = Uuid::random(), second = Uuid::random();
  log.begin(first, 0);
  log.begin(second, 50);
  EXPECT_TRUE(log.contains({first, 1}, 70));
  EXPECT_TRUE(log.contains({first, 50}, 70));
  EXPECT_FALSE(log.contains({first, 51}, 70));  // cut off, though the position is beyond it by now
  EXPECT_TRUE(log.contains({second, 70}, 70));
  EXPECT_FALSE(log.contains({second, 71}, 70));
  EXPECT_FALSE(log.contains({Uuid::random(), 1}, 70));
}

TEST(TimelineHistory, APositionIsNamedByTheRunThatWroteIt) {
  TimelineHistory log(kEpoch);
  const Uuid first = Uuid::random(), second = Uuid::random();
  log.begin(first, 10);
  EXPECT_EQ(log.at(10), (LogPosition{first, 10}));
  log.begin(second, 50);
  EXPECT_EQ(log.at(50), (LogPosition{first, 50}));
  EXPECT_EQ(log.at(51), (LogPosition{second, 51}));
  EXPECT_TRUE(log.contains(log.at(50), 50));
}

TEST(TimelineHistory, ARunThatWroteNothingIsForgottenAndWasNeverNamed) {
  TimelineHistory log(kEpoch);
  log.begin(Uuid::random(), 0);
  for (int i = 0; i < 1000; ++i) {
    log.begin(Uuid::random(), 7);
    EXPECT_TRUE(log.contains(log.at(7), 7));
  }
  EXPECT_LT(log.text().size(), 200U);
}

TEST(TimelineHistory, OfManyRunsTheOldestAreForgottenAndCountAsKept) {
  TimelineHistory log(kEpoch);
  const Uuid first = Uuid::random();
  log.begin(first, 0);
  for (std::uint64_t position = 1; position <= 1000; ++position)
    log.begin(Uuid::random(), position);
  EXPECT_LT(log.text().size(), 15'000U);
  EXPECT_TRUE(log.contains({first, 1}, 1000));
  EXPECT_FALSE(log.contains({Uuid::random(), 999}, 1000));
}

TEST(TimelineHistory, ComesBackFromItsText) {
  TimelineHistory log(kEpoch);
  const Uuid run = Uuid::random();
  log.begin(run, 3);
  log.begin(Uuid::random(), 9);
  const std::optional<TimelineHistory> read = TimelineHistory::parse(log.text());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->epoch(), kEpoch);
  EXPECT_EQ(read->text(), log.text());
  EXPECT_FALSE(read->contains({run, 10}, 20));
  for (const char* const text : {"", "x", "0\n"})
    EXPECT_FALSE(TimelineHistory::parse(text)) << text;
  EXPECT_FALSE(TimelineHistory::parse(log.text() + "nobody 3\n"));
}

TEST(ConsistencyToken, IsVerifiedByItsOwnKeyInThisEpochAlone) {
  const Digest key = *Digest::from_hex(std::string(64, 'a'));
  const LogPosition point{Uuid::random(), 0x0102030405060708};
  const ConsistencyToken token = sign(key, kEpoch, point);
  EXPECT_EQ(verify(key, kEpoch, token), point);
  EXPECT_FALSE(verify(key, Uuid::random(), token));
  EXPECT_FALSE(verify(Digest{}, kEpoch, token));
  EXPECT_FALSE(verify(key, kEpoch, {}));
  for (std::size_t i = 0; i < token.size(); ++i) {
    ConsistencyToken other = token;
    other[i] ^= 1;
    EXPECT_FALSE(verify(key, kEpoch, other)) << i;
  }
}

}  // namespace
}  // namespace kinship::store::timeline_history_test
