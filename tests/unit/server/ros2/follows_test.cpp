#include "server/ros2/follows.hpp"

#include <gtest/gtest.h>

namespace kinship::ros2 {
namespace {

constexpr Follows::TimePoint kNow{std::chrono::hours(1)};
constexpr std::chrono::seconds kMinute{60};

FetchRequest query(const std::string& task) {
  FetchRequest query;
  query.task = task;
  query.deadline = std::chrono::seconds(5);
  query.follow = kMinute;
  return query;
}

Announcement announcement_of(const std::string& task) {
  Announcement announcement;
  announcement.task = task;
  return announcement;
}

TEST(Follows, AQueryIsAskedOnceForAnAnnouncementOfItsTaskUntilItEnds) {
  Follows follows;
  EXPECT_TRUE(follows.keep("node", query("shelf"), kNow));
  EXPECT_TRUE(follows.keep("node", query("shelf"), kNow)) << "in place of the one before";
  EXPECT_TRUE(follows.of(announcement_of("bin"), kNow).empty());
  const auto found = follows.of(announcement_of("shelf"), kNow);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].client, "node");
  EXPECT_EQ(found[0].query.follow.count(), 0);
  EXPECT_EQ(found[0].query.deadline.count(), 0);
  EXPECT_TRUE(follows.of(announcement_of("shelf"), kNow + kMinute).empty());
}

TEST(Follows, PlacementsAreFollowedBesideEachOther) {
  Follows follows;
  FetchRequest placed = query("shelf");
  placed.T_task_base = Eigen::Isometry3d::Identity();
  EXPECT_TRUE(follows.keep("node", placed, kNow));
  placed.T_task_base->translation().x() = 0.01;
  EXPECT_TRUE(follows.keep("node", placed, kNow));
  EXPECT_EQ(follows.of(announcement_of("shelf"), kNow).size(), 2U);
}

TEST(Follows, ANodeWithTooManyHasNoMoreUntilOnesOfItEnd) {
  Follows follows;
  for (std::size_t i = 0; i < Follows::kMaxOfClient; ++i)
    EXPECT_TRUE(follows.keep("greedy", query("task" + std::to_string(i)), kNow));
  EXPECT_FALSE(follows.keep("greedy", query("one more"), kNow));
  EXPECT_TRUE(follows.keep("other", query("one more"), kNow));
  EXPECT_TRUE(follows.keep("greedy", query("one more"), kNow + kMinute));
}

TEST(Follows, NodesThatHaveLeftAreForgottenAndMakeRoom) {
  Follows follows;
  EXPECT_TRUE(follows.empty());
  for (std::size_t i = 0; i < Follows::kMaxOfClient; ++i)
    EXPECT_TRUE(follows.keep("gone", query("task" + std::to_string(i)), kNow));
  EXPECT_TRUE(follows.keep("here", query("task1"), kNow));
  follows.keep_only({"here", "silent"});
  const auto found = follows.of(announcement_of("task1"), kNow);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].client, "here");
  EXPECT_TRUE(follows.keep("gone", query("one more"), kNow)) << "its places are free";
  follows.keep_only({});
  EXPECT_TRUE(follows.empty());
}

}  // namespace
}  // namespace kinship::ros2
