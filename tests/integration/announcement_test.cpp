// kinshipd keeps a followed distribution up with the experience and says so, without being asked.

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <vector>

#include "client/link/client.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/publication.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::announcement_test {
namespace {

using std::chrono::seconds;

/// The announcements of a server, as they come.
class Listener {
 public:
  explicit Listener(std::uint32_t domain)
      : participant_({.domain = domain, .role = dds::Role::Client, .network_interface = ""}),
        subscriber_(participant_,
                    {.on_sample = [this](const Announcement& a) { add(a); }, .on_server = {}}) {}

  /// Waits for a revision of a distribution, or a later one. \return 0 if it does not come.
  std::uint64_t wait_for(const Digest& id, std::uint64_t revision) {
    constexpr seconds kPatience(100);
    std::unique_lock lock(mutex_);
    std::uint64_t heard = 0;
    changed_.wait_for(lock, kPatience, [&] {
      for (const Announcement& announcement : heard_)
        if (announcement.distribution_id == id && announcement.revision >= revision)
          heard = announcement.revision;
      return heard > 0;
    });
    return heard;
  }

 private:
  void add(const Announcement& announcement) {
    const std::lock_guard lock(mutex_);
    heard_.push_back(announcement);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Announcement> heard_;  // guarded by mutex_
  dds::Participant participant_;
  dds::Subscriber<codec::AnnouncementPublication> subscriber_;
};

TEST(Announcements, TellOfARefitThatNobodyAskedFor) {
  const test::ReservedDomain domain;
  const test::TemporaryDirectory directory;
  const test::ServerProcess server(
      {.store = directory / "fleet.db", .domain = domain.number(), .arguments = {}});
  link::Client client(
      {.domain = domain.number(), .outbox = directory / "outbox", .timeout = seconds(60)});
  const auto register_model = [&client](const std::string& name) {
    return client.register_robot(test::model_description(name)).value_or_throw().robot;
  };
  const Digest panda = register_model("panda");
  FetchRequest request;
  request.robot = register_model("ur10e");
  request.task = "sweep";
  request.deadline = seconds(100);
  request.follow = seconds(3600);
  const auto report = [&](std::uint64_t first, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i)
      client.report(test::panda_attempt(panda, "sweep", first + i));
    EXPECT_EQ(client.flush(seconds(100)).pending, 0U);
  };
  Listener listener(domain.number());

  report(0, 6);
  const FetchReply first = client.fetch(request).value_or_throw();
  ASSERT_EQ(first.status, FetchStatus::Ready) << first.message;
  const Digest id = first.distribution->id;
  EXPECT_EQ(listener.wait_for(id, 1), 1U);

  report(100, 5);
  EXPECT_EQ(listener.wait_for(id, 2), 2U);

  request.deadline = seconds(0);
  const FetchReply second = client.fetch(request).value_or_throw();
  ASSERT_EQ(second.status, FetchStatus::Ready) << second.message;
  EXPECT_EQ(second.distribution->revision, 2U);
  EXPECT_EQ(second.distribution->sources.at(0).paths, 11U);
  const AdminReply status = client.admin({}).value_or_throw();
  EXPECT_EQ(json::row_from_json<ServerStatus>(status.rows.at(0)).value_or_throw().followed, 1U);

  // Who comes late hears of the newest revision.
  EXPECT_EQ(Listener(domain.number()).wait_for(id, 1), 2U);
}

}  // namespace
}  // namespace kinship::announcement_test
