// A publishing server and its subscribers, in processes of their own.

#include "proto/dds/publication.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "proto/dds/requester.hpp"
#include "proto/dds/wire.hpp"
#include "proto/types/limits.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/reserved_domain.hpp"

namespace kinship::dds::publication_test {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::seconds kPatience{60};

/// A server process that publishes what it is told.
class PublishingServer {
 public:
  explicit PublishingServer(const Participant& participant)
      : process_({KINSHIP_PUBLICATION_SERVER, std::to_string(participant.options().domain)}),
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
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  Announcements heard(participant);
  PublishingServer server(participant);
  ASSERT_TRUE(heard.wait_for_servers(1));
  server.tell("announce 1 5");
  server.tell("announce 1 6");
  EXPECT_TRUE(heard.wait_for_revision(1, 6));
  EXPECT_EQ(heard.values().back().task, "bin_to_shelf");
}

TEST(Publication, LateJoinerHearsTheNewestOfEachDistributionOnce) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  PublishingServer server(participant);
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
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  PublishingServer server(participant);
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
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  Announcements heard(participant);
  {
    PublishingServer first(participant);
    first.tell("announce 1 5");
    EXPECT_TRUE(heard.wait_for_revision(1, 5));
    first.kill();
  }
  PublishingServer second(participant);
  EXPECT_TRUE(heard.wait_for_servers(2));
  second.tell("announce 1 2");  // an older store: told as it is, epoch and revision say so
  EXPECT_TRUE(heard.wait_for_revision(1, 2));
}

TEST(Publication, EventReachesWhoListensButNotWhoComesLater) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  PublishingServer server(participant);
  server.tell("event before");
  Heard<Event> heard;
  const Subscriber<codec::EventPublication> subscriber(
      participant, {.on_sample = [&](const Event& event) { heard.add(event); },
                    .on_server = [&] { heard.add_server(); }});
  ASSERT_TRUE(heard.wait_for_servers(1));
  // The server may match its side a moment later: it tells until it is heard.
  for (int i = 0; i < 300 && heard.values().empty(); ++i) {
    server.tell("event after " + std::to_string(i));
    std::this_thread::sleep_for(100ms);
  }
  ASSERT_FALSE(heard.values().empty());
  for (const Event& event : heard.values())
    EXPECT_NE(event.text, "before");
}

TEST(Publication, NoHandlerRunsAfterTheSubscriberIsGone) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  PublishingServer server(participant);
  auto flood = std::async(std::launch::async, [&] { return server.tell("flood 5000"); });
  std::atomic<int> calls = 0;
  while (flood.wait_for(0ms) != std::future_status::ready) {
    std::atomic<bool> is_gone = false;
    {
      const Subscriber<codec::EventPublication> subscriber(participant,
                                                           {.on_sample =
                                                                [&](const Event&) {
                                                                  ++calls;
                                                                  std::this_thread::yield();
                                                                  EXPECT_FALSE(is_gone);
                                                                },
                                                            .on_server = {}});
      std::this_thread::sleep_for(5ms);
    }
    is_gone = true;
  }
  EXPECT_NE(flood.get(), "");
}

TEST(Publication, StoppedSubscriberHoldsNobodyUpAndHearsTheNewestWhenItGoesOn) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number()});
  PublishingServer server(participant);
  server.tell("announce 1 5");
  test::ChildProcess listener({KINSHIP_PUBLICATION_LISTENER, std::to_string(domain.number())});
  ASSERT_EQ(listener.read_line(), "announcement 1 5");
  listener.signal(SIGSTOP);
  const std::string slow = server.tell("flood 16000");
  EXPECT_LT(std::stoi(slow), 10) << slow;  // a writer that blocks: 100 ms each time
  server.tell("announce 1 6");
  listener.signal(SIGCONT);
  std::string line = listener.read_line();
  while (line.starts_with("event") || line == "announcement 1 5")
    line = listener.read_line();
  EXPECT_EQ(line, "announcement 1 6");
}

/// Bytes of a publication on the wire.
template <typename Publication>
std::size_t size_of(const Participant& participant, const typename Publication::Value& value) {
  const PublicationTopic type = Wire<Publication>::topic();
  const Entity topic(
      dds_create_topic(participant.get(), &type.type, type.name.c_str(), nullptr, nullptr),
      type.name);
  const Entity reader(dds_create_reader(participant.get(), topic.get(), type.qos.get(), nullptr),
                      type.name);
  WaitLoop loop(participant);
  const Publisher<Publication> publisher(participant, loop);
  publisher.publish(value);  // within a participant it arrives before this returns
  ddsi_serdata* sample = nullptr;
  dds_sample_info_t info{};
  if (dds_takecdr(reader.get(), &sample, 1, &info, DDS_ANY_STATE) != 1)
    return 0;
  const std::size_t bytes = ddsi_serdata_size(sample);
  ddsi_serdata_unref(sample);
  return bytes;
}

TEST(Publication, IsShortOnTheWire) {
  const test::ReservedDomain domain;
  const Participant participant({.domain = domain.number(), .role = Role::Server});
  Announcement announcement;
  announcement.task = "bin_to_shelf";
  EXPECT_EQ(size_of<codec::AnnouncementPublication>(participant, announcement), 116U);
  announcement.task = std::string(kMaxTaskBytes, 't');
  EXPECT_EQ(size_of<codec::AnnouncementPublication>(participant, announcement), 232U);
  const std::string text(10'000, 'x');  // is cut
  const Event event{
      .kind = EventKind::Refusal, .time_ms = 1, .task = text, .robot = text, .text = text};
  EXPECT_EQ(size_of<codec::EventPublication>(participant, event), 748U);
}

}  // namespace
}  // namespace kinship::dds::publication_test
