#include "server/catalog/freshness.hpp"

#include <gtest/gtest.h>

namespace kinship::catalog::freshness_test {
namespace {

Digest robot(std::uint8_t number) {
  Digest digest;
  digest.bytes[0] = number;
  return digest;
}

/// Of robot 1, fitted to so many paths of robots 1 and 2, at generations 3 and 7.
Distribution fitted(std::uint64_t paths_1, std::uint64_t paths_2) {
  Distribution distribution;
  distribution.robot = robot(1);
  distribution.fitted_ms = 1'000'000;
  distribution.sources.resize(2);
  Source& first = distribution.sources[0];
  first.robot = robot(1), first.paths = paths_1, first.generation = 3;
  Source& second = distribution.sources[1];
  second.robot = robot(2), second.paths = paths_2, second.generation = 7;
  return distribution;
}

TEST(Freshness, SmallExperienceGrowsByFivePaths) {
  const Distribution distribution = fitted(10, 10);
  EXPECT_FALSE(has_grown(distribution, {{robot(1), 12, 5}, {robot(2), 12, 9}}));
  EXPECT_TRUE(has_grown(distribution, {{robot(1), 12, 5}, {robot(2), 13, 9}}));
}

TEST(Freshness, LargeExperienceGrowsByFivePercent) {
  const Distribution distribution = fitted(1000, 1000);
  EXPECT_FALSE(has_grown(distribution, {{robot(1), 1099, 5}, {robot(2), 1000, 9}}));
  EXPECT_TRUE(has_grown(distribution, {{robot(1), 1100, 5}, {robot(2), 1000, 9}}));
}

TEST(Freshness, PathsOfANewRobotCount) {
  EXPECT_TRUE(has_grown(fitted(10, 10), {{robot(1), 10, 3}, {robot(2), 10, 7}, {robot(3), 5, 1}}));
}

TEST(Freshness, WhatTakesThePlaceOfOthersBeyondTheCapCounts) {
  const Distribution distribution = fitted(1000, 10);  // at generations 3 and 7
  const auto full = [](std::uint64_t generation, std::uint64_t paths, std::uint64_t dropped) {
    return std::vector<store::ExperienceSummary>{
        {.robot = robot(1), .paths = paths, .generation = generation, .dropped = dropped},
        {.robot = robot(2), .paths = 10, .generation = 7}};
  };
  EXPECT_FALSE(has_grown(distribution, full(52, 1000, 400)));
  EXPECT_TRUE(has_grown(distribution, full(53, 1000, 400)));
  EXPECT_FALSE(has_grown(distribution, full(53, 1000, 0))) << "not at a cap";
  EXPECT_FALSE(has_grown(distribution, full(52, 1049, 1))) << "all of it was growth";
  EXPECT_TRUE(has_grown(distribution, full(53, 1049, 1)));
}

TEST(Freshness, AfterACapWasLoweredWhatIsLeftIsToBeOutgrown) {
  const Distribution distribution = fitted(100'000, 10);  // at generations 3 and 7
  const auto at_cap = [](std::uint64_t generation) {
    return std::vector<store::ExperienceSummary>{
        {.robot = robot(1), .paths = 200, .generation = generation, .dropped = 99'800},
        {.robot = robot(2), .paths = 10, .generation = 7}};
  };
  EXPECT_FALSE(has_grown(distribution, at_cap(3 + 9)));
  EXPECT_TRUE(has_grown(distribution, at_cap(3 + 10)));
}

TEST(Freshness, AnyOtherGenerationOrRobotIsAChange) {
  const Distribution distribution = fitted(10, 10);
  EXPECT_FALSE(has_changed(distribution, {{robot(1), 10, 3}, {robot(2), 10, 7}}));
  EXPECT_TRUE(has_changed(distribution, {{robot(1), 10, 3}, {robot(2), 10, 8}}));
  EXPECT_TRUE(has_changed(distribution, {{robot(1), 10, 3}}));
  EXPECT_TRUE(has_changed(distribution, {{robot(1), 10, 3}, {robot(3), 10, 7}}));
}

TEST(Freshness, WithADateTheGrowthIsThatOfWhatCouldBeUsed) {
  Distribution distribution = fitted(1000, 1000);
  distribution.sources[0].paths_used = 40;
  EXPECT_FALSE(has_grown(distribution, {{robot(1), 1005, 5}, {robot(2), 1000, 9}}));
  distribution.selection.since_ms = 1;
  EXPECT_FALSE(has_grown(distribution, {{robot(1), 1004, 5}, {robot(2), 1000, 9}}));
  EXPECT_TRUE(has_grown(distribution, {{robot(1), 1005, 5}, {robot(2), 1000, 9}}));
}

TEST(Freshness, ADistributionIsRetiredWithAnyOfItsSources) {
  const Distribution distribution = fitted(10, 10);  // at generations 3 and 7
  EXPECT_FALSE(is_retired(distribution, {{robot(1), 10, 3, 2}, {robot(2), 10, 7, 7}}))
      << "it was fitted after that";
  EXPECT_FALSE(
      is_retired(distribution, {{robot(1), 10, 3}, {robot(2), 10, 7}, {robot(3), 0, 9, 9}}));
  EXPECT_TRUE(is_retired(distribution, {{robot(1), 9, 4, 4}, {robot(2), 10, 7}}));
  EXPECT_TRUE(is_retired(distribution, {{robot(1), 12, 6, 4}, {robot(2), 10, 7}}));
  EXPECT_TRUE(is_retired(distribution, {{robot(1), 10, 3}})) << "robot 2 has no experience left";
  EXPECT_TRUE(is_retired(distribution, {{robot(1), 10, 3}, {robot(2), 1, 1}})) << "another task";
}

TEST(Freshness, AMixtureIsBehindByGrowthAndAFailureByAnyChange) {
  Distribution distribution = fitted(10, 10);
  const std::vector<store::ExperienceSummary> one_more = {{robot(1), 11, 4}, {robot(2), 10, 7}};
  EXPECT_FALSE(is_behind(distribution, one_more));
  distribution.state = DistributionState::Failed;
  EXPECT_TRUE(is_behind(distribution, one_more));
}

TEST(Freshness, RefitsWaitForTheIntervalUnlessTheClockWasSetBack) {
  const Distribution distribution = fitted(10, 10);
  EXPECT_FALSE(may_refit(distribution, 1'000'000));
  EXPECT_FALSE(may_refit(distribution, 1'009'999));
  EXPECT_TRUE(may_refit(distribution, 1'010'000));
  EXPECT_TRUE(may_refit(distribution, 999'999));
}

TEST(Freshness, OwnGenerationIsZeroWithoutExperience) {
  Distribution distribution = fitted(10, 10);
  EXPECT_EQ(own_generation(distribution), 3U);
  EXPECT_EQ(generation_of(robot(2), {{robot(1), 1, 5}, {robot(2), 1, 9}}), 9U);
  EXPECT_EQ(generation_of(robot(3), {{robot(1), 1, 5}}), 0U);
  distribution.robot = robot(3);
  EXPECT_EQ(own_generation(distribution), 0U);
}

}  // namespace
}  // namespace kinship::catalog::freshness_test
