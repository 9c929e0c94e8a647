#include "server/console/broadcast.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <memory>

namespace kinship::console::broadcast_test {
namespace {

constexpr std::chrono::seconds kEnough{20};

/// A browser's end of a stream.
class Listener {
 public:
  http::Send send() {
    return [this](const std::shared_ptr<const std::string>& part) {
      const std::lock_guard lock(mutex_);
      text_ += *part;
      changed_.notify_all();
      return is_open_;
    };
  }
  bool hears(const std::string& text) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kEnough, [&] { return text_.find(text) != std::string::npos; });
  }
  void leave() {
    const std::lock_guard lock(mutex_);
    is_open_ = false;
  }
  std::string text() {
    const std::lock_guard lock(mutex_);
    return text_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string text_;
  bool is_open_ = true;
};

Event event(const std::string& text) {
  return {.kind = EventKind::Report, .time_ms = 1, .task = "shelf", .robot = "panda", .text = text};
}

TEST(Broadcast, TellsTheStatusAndEventsToAllListeners) {
  Listener first, second;
  Broadcast broadcast;
  std::atomic<int> statuses = 0;
  broadcast.start([&] { return "{\"n\":" + std::to_string(++statuses) + "}"; });
  EXPECT_TRUE(broadcast.add(first.send()));
  EXPECT_TRUE(broadcast.add(second.send()));
  EXPECT_TRUE(first.hears("event: status\ndata: {\"n\":"));
  broadcast.publish(event("3 stored"));
  for (Listener* each : {&first, &second})
    EXPECT_TRUE(
        each->hears("event: event\ndata: "
                    "{\"format\":\"kinship.event/1\",\"time_ms\":1,\"kind\":\"report\",\"task\":"
                    "\"shelf\",\"robot\":\"panda\",\"text\":\"3 stored\"}\n\n"))
        << each->text();
  EXPECT_TRUE(first.hears("{\"n\":3}")) << "once a second";
}

TEST(Broadcast, AsksForNothingWhileNobodyListens) {
  Listener listener;
  Broadcast broadcast;
  std::atomic<int> statuses = 0;
  broadcast.start([&] {
    ++statuses;
    return std::string("{}");
  });
  broadcast.publish(event("unheard"));
  EXPECT_EQ(statuses, 0);
  broadcast.add(listener.send());
  EXPECT_TRUE(listener.hears("event: status"));
  EXPECT_EQ(listener.text().find("unheard"), std::string::npos);
  listener.leave();
  const auto end = std::chrono::steady_clock::now() + kEnough;
  while (broadcast.listeners() > 0 && std::chrono::steady_clock::now() < end)
    std::this_thread::yield();
  EXPECT_EQ(broadcast.listeners(), 0U);
}

TEST(Broadcast, LeavesOutWhatIsTooMuchAndSaysHowMuch) {
  Listener listener;
  Broadcast broadcast;
  broadcast.add(listener.send());
  for (std::size_t i = 0; i < Broadcast::kMaxGathered + 7; ++i)
    broadcast.publish(event("number " + std::to_string(i)));
  broadcast.start([] { return std::string("{}"); });
  EXPECT_TRUE(listener.hears("event: left_out\ndata: 7\n\n"));
  EXPECT_NE(listener.text().find("number " + std::to_string(Broadcast::kMaxGathered - 1)),
            std::string::npos);
}

TEST(Broadcast, HasRoomForSoMany) {
  Listener listener;
  Broadcast broadcast;
  for (std::size_t i = 0; i < Broadcast::kMaxListeners; ++i)
    EXPECT_TRUE(broadcast.add(listener.send()));
  EXPECT_FALSE(broadcast.add(listener.send()));
}

}  // namespace
}  // namespace kinship::console::broadcast_test
