// A publishing server and its subscribers, in processes of their own. Each test has a domain of its
// own.

#include "proto/dds/publication.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "proto/dds/requester.hpp"
#include "tests/support/child_process.hpp"

namespace kinship::dds {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::seconds kPatience{30};

/// A server process that publishes what it is told.
class PublishingServer {
 public:
  PublishingServer(const Participant& participant, std::uint32_t domain)
      : process_({KINSHIP_PUBLICATION_SERVER, std::to_string(domain)}),
        requester_(participant, Uuid::random()) {
    EXPECT_EQ(process_.read_line(), "ready");
  }

  /// \return its answer; what it was told is published.
  std::string tell(const std::string& command) {
    AdminRequest request;
    request.argument = command;
    const auto reply = requester_.call(request, std::chrono::steady_clock::now() + kPatience);
    return reply ? reply->rows.at(0) : reply.error().message;
  }

  void kill() { process_.kill(); }

 private:
  test::ChildProcess process_;
  Requester<codec::AdminConversation> requester_;
};

/// What a subscriber heard; may be waited for.
template <typename Value>
class Heard {
 public:
  void add(const Value& value) {
    const std::lock_guard lock(mutex_);
    values_.push_back(value);
    changed_.notify_all();
  }
  void add_server() {
    const std::lock_guard lock(mutex_);
    ++servers_;
    changed_.notify_all();
  }

  template <typename Predicate>
  bool wait_for(Predicate predicate) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return predicate(values_); });
  }
  bool wait_for_servers(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return servers_ >= count; });
  }
  std::vector<Value> values() {
    const std::lock_guard lock(mutex_);
    return values_;
  }

 private:
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::vector<Value> values_;
  int servers_ = 0;
};

class Announcements : public Heard<Announcement> {
 public:
  explicit Announcements(const Participant& participant)
      : subscriber_(participant, {.on_sample = [this](const Announcement& a) { add(a); },
                                  .on_server = [this] { add_server(); }}) {}

  /// Waits until the newest revision of a distribution is this one.
  bool wait_for_revision(unsigned number, std::uint64_t revision) {
    return wait_for(
        [&](const std::vector<Announcement>& all) { return newest(all, number) == revision; });
  }
  std::uint64_t newest(unsigned number) { return newest(values(), number); }

 private:
  static std::uint64_t newest(const std::vector<Announcement>& all, unsigned number) {
    std::uint64_t revision = 0;
    for (const Announcement& announcement : all)
      if (announcement.distribution_id.bytes[0] == number)
        revision = announcement.revision;
    return revision;
  }

  Subscriber<codec::AnnouncementPublication> subscriber_;
};

TEST(Publication, AnnouncementReachesWhoListens) {
  const Participant participant({.domain = 150});
  Announcements heard(participant);
  PublishingServer server(participant, 150);
  ASSERT_TRUE(heard.wait_for_servers(1));
  server.tell("announce 1 5");
  server.tell("announce 1 6");
  EXPECT_TRUE(heard.wait_for_revision(1, 6));
  EXPECT_EQ(heard.values().back().task, "bin_to_shelf");
}

TEST(Publication, LateJoinerHearsTheNewestOfEachDistributionOnce) {
  const Participant participant({.domain = 151});
  PublishingServer server(participant, 151);
  for (const char* command : {"announce 1 5", "announce 2 8", "announce 1 6", "announce 1 7"})
    server.tell(command);
  Announcements late(participant);
  EXPECT_TRUE(late.wait_for_revision(1, 7));
  EXPECT_TRUE(late.wait_for_revision(2, 8));
  server.tell("announce 3 1");  // comes last: whatever else there was has come before
  EXPECT_TRUE(late.wait_for_revision(3, 1));
  EXPECT_EQ(late.values().size(), 3U);
}

TEST(Publication, WithdrawnDistributionIsNotAnnouncedToALateJoiner) {
  const Participant participant({.domain = 152});
  PublishingServer server(participant, 152);
  for (const char* command : {"announce 1 5", "announce 2 8", "withdraw 1"})
    server.tell(command);
  Announcements late(participant);
  EXPECT_TRUE(late.wait_for_revision(2, 8));
  server.tell("announce 3 1");
  EXPECT_TRUE(late.wait_for_revision(3, 1));
  EXPECT_EQ(late.newest(1), 0U);
  server.tell("announce 1 6");  // followed again
  EXPECT_TRUE(late.wait_for_revision(1, 6));
}

TEST(Publication, SubscriberHearsTheServerAfterOneThatWasKilled) {
  const Participant participant({.domain = 153});
  Announcements heard(participant);
  {
    PublishingServer first(participant, 153);
    first.tell("announce 1 5");
    EXPECT_TRUE(heard.wait_for_revision(1, 5));
    first.kill();
  }
  PublishingServer second(participant, 153);
  EXPECT_TRUE(heard.wait_for_servers(2));
  second.tell("announce 1 2");  // an older store: told as it is, epoch and revision say so
  EXPECT_TRUE(heard.wait_for_revision(1, 2));
}

}  // namespace
}  // namespace kinship::dds
