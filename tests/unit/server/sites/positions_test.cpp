#include "server/sites/positions.hpp"

#include <gtest/gtest.h>

#include "server/sites/wanted_tasks.hpp"
#include "tests/unit/server/sites/site_and_memory.hpp"

namespace kinship::sites::positions_test {
namespace {

using PositionsTest = SiteAndMemory;

TEST_F(PositionsTest, AreThereAgainAfterARestart) {
  {
    Positions positions(*site_);
    EXPECT_TRUE(positions.begin(site_->epoch(), memory_->epoch()));
    positions.up = "12:34 x";
    positions.passed = 12;
    positions.up_retired = "5";
    positions.down_retired = "6";
    positions.token = {0, 255, 17};
    positions.tasks["shelf 2"] = {"opaque cursor", 1'700'000'000'000};
    positions.refuse({test::id_from<Uuid>(1), "it has no joints"}, false);
    positions.save();
  }
  site_.reset();
  site_ = store::open_sqlite_store(directory_ / "site.db");
  Positions positions(*site_);
  EXPECT_EQ(positions.up, "12:34 x");
  EXPECT_EQ(positions.passed, 12U);
  EXPECT_EQ(positions.up_retired, "5");
  EXPECT_EQ(positions.down_retired, "6");
  EXPECT_EQ(positions.token, (ConsistencyToken{0, 255, 17}));
  ASSERT_EQ(positions.tasks.size(), 1U);
  EXPECT_EQ(positions.tasks["shelf 2"].cursor, "opaque cursor");
  EXPECT_EQ(positions.tasks["shelf 2"].used_ms, 1'700'000'000'000);
  ASSERT_EQ(positions.refused_count(), 1U);
  EXPECT_EQ(positions.refused(false).begin()->second.why, "it has no joints");
  EXPECT_FALSE(positions.refused(false).begin()->second.is_put_off);
  EXPECT_FALSE(positions.begin(site_->epoch(), memory_->epoch())) << "the epochs are the same";
}

TEST_F(PositionsTest, BeginAgainWithAnotherEpochOfEitherSide) {
  Positions positions(*site_);
  positions.begin(site_->epoch(), memory_->epoch());
  for (const auto& [site, memory] : {std::pair(test::id_from<Uuid>(1), memory_->epoch()),
                                     std::pair(test::id_from<Uuid>(1), test::id_from<Uuid>(2))}) {
    positions.up = "7";
    positions.passed = 7;
    positions.up_retired = "8";
    positions.down_retired = "9";
    positions.token = {1};
    positions.tasks["shelf"] = {"9", 5};
    positions.refuse({test::id_from<Uuid>(3), "why"}, true);
    positions.save();
    EXPECT_TRUE(positions.begin(site, memory));
    EXPECT_EQ(positions.up + positions.tasks["shelf"].cursor, "");
    EXPECT_EQ(positions.up_retired + positions.down_retired, "");
    EXPECT_EQ(positions.passed, 0U);
    EXPECT_TRUE(positions.token.empty());
    EXPECT_EQ(positions.tasks["shelf"].used_ms, 5) << "it is wanted as before";
    EXPECT_EQ(Positions(*site_).refused_count(), 0U);
  }
}

TEST_F(PositionsTest, WhatIsTakenIsNotRefusedAnyMore) {
  Positions positions(*site_);
  positions.refuse({test::id_from<Uuid>(3), "why"}, true);
  positions.save();
  positions.accept(test::id_from<Uuid>(3), true);
  positions.save();
  EXPECT_EQ(Positions(*site_).refused_count(), 0U);
}

TEST_F(PositionsTest, ARefusalUpwardsAndOneDownwardsAreTwo) {
  const Uuid report = test::id_from<Uuid>(3);
  Positions positions(*site_);
  positions.refuse({report, "put off", true}, true);
  positions.refuse({report, "two contents"}, false);
  positions.save();
  Positions again(*site_);
  ASSERT_EQ(again.refused_count(), 2U);
  EXPECT_EQ(again.refused(true).at(report).why, "put off");
  EXPECT_TRUE(again.refused(true).at(report).is_put_off);
  EXPECT_EQ(again.refused(false).at(report).why, "two contents");
  EXPECT_FALSE(again.has_changed());
  again.accept(report, false);
  again.save();
  EXPECT_EQ(Positions(*site_).refused(true).count(report), 1U);
}

TEST_F(PositionsTest, RefusalsForGoodLeaveRoomForThoseThatArePutOff) {
  Positions positions(*site_);
  for (std::uint64_t number = 0; number < Positions::kMaxRefused; ++number)
    ASSERT_TRUE(positions.refuse({test::id_from<Uuid>(number), "why"}, number % 2 == 0));
  const Uuid more = test::id_from<Uuid>(1'000'000);
  EXPECT_FALSE(positions.refuse({more, "why"}, true));
  EXPECT_TRUE(positions.refuse({more, "why", true}, true));
  EXPECT_TRUE(positions.refuse({test::id_from<Uuid>(0), "another reason"}, true)) << "it is known";
  positions.accept(test::id_from<Uuid>(2), true);
  EXPECT_TRUE(positions.refuse({test::id_from<Uuid>(2'000'000), "why"}, true));
}

TEST(WantedTasks, AStarIsAnythingAQuestionMarkOne) {
  EXPECT_TRUE(matches("*", "shelf"));
  EXPECT_TRUE(matches("shelf", "shelf"));
  EXPECT_FALSE(matches("shelf", "shelf_2"));
  EXPECT_TRUE(matches("shelf*", "shelf_2"));
  EXPECT_TRUE(matches("*/pick", "hall 3/pick"));
  EXPECT_FALSE(matches("bin_?", "bin_10"));
  EXPECT_TRUE(matches_any({"a", "b*"}, "bin"));
  EXPECT_FALSE(matches_any({}, "bin"));
}

}  // namespace
}  // namespace kinship::sites::positions_test
