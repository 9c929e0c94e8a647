#include "server/service/event_feed.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "proto/types/limits.hpp"

namespace kinship::service::event_feed_test {
namespace {

class EventFeedTest : public testing::Test {
 protected:
  void tell(const std::string& text) {
    feed_.tell(EventKind::Fit, "shelf", "panda", [&] {
      ++texts_made_;
      return text;
    });
  }

  std::int64_t time_ms_ = 5000;
  runtime::Clock clock_{
      .now =
          [this] {
            return std::chrono::steady_clock::time_point(std::chrono::milliseconds(time_ms_));
          },
      .unix_ms = [this] { return time_ms_; }};
  std::vector<Event> events_;
  int texts_made_ = 0;
  EventFeed feed_{clock_, [this](const Event& event) { events_.push_back(event); }, 3};
};

TEST_F(EventFeedTest, TellsWhatHappenedWhen) {
  tell("fitted");
  ASSERT_EQ(events_.size(), 1U);
  EXPECT_EQ(events_[0].kind, EventKind::Fit);
  EXPECT_EQ(events_[0].time_ms, 5000);
  EXPECT_EQ(events_[0].task, "shelf");
  EXPECT_EQ(events_[0].robot, "panda");
  EXPECT_EQ(events_[0].text, "fitted");
}

TEST_F(EventFeedTest, LeavesOutWhatIsTooMuchInASecondAndSaysSoLater) {
  for (int i = 0; i < 10; ++i)
    tell("fit " + std::to_string(i));
  EXPECT_EQ(events_.size(), 3U);
  EXPECT_EQ(texts_made_, 3);
  EXPECT_EQ(feed_.dropped(), 7U);
  time_ms_ += 1000;
  tell("next");
  ASSERT_EQ(events_.size(), 5U);
  EXPECT_EQ(events_[3].text, "7 events were not told, at most 3 a second are");
  EXPECT_EQ(events_[4].text, "next");
  tell("one more");
  EXPECT_EQ(events_.size(), 6U);
}

TEST_F(EventFeedTest, TextsAreCutToTheLimit) {
  tell(std::string(2 * kMaxEventBytes, 'x'));
  EXPECT_EQ(events_.at(0).text.size(), kMaxEventBytes);
}

TEST_F(EventFeedTest, WithoutASinkNothingIsMade) {
  EventFeed silent(clock_, {});
  silent.tell(EventKind::Fit, "", "", [&] {
    ++texts_made_;
    return "text";
  });
  EXPECT_EQ(texts_made_, 0);
}

}  // namespace
}  // namespace kinship::service::event_feed_test
