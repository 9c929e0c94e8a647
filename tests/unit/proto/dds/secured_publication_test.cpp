// Who hears what of a server with security: a publishing server in a process of its own.

#include <dds/dds.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "proto/dds/publication.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/requester.hpp"
#include "proto/dds/wire.hpp"
#include "proto/security/private_files.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::dds::secured_publication_test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr auto kPatience = 30s;

/// What a subscriber heard; may be waited for.
class Heard {
 public:
  explicit Heard(const Participant& participant)
      : subscriber_(participant, {.on_sample = [this](const Announcement& a) { add(a); },
                                  .on_server = [this] { count(servers_); },
                                  .on_server_gone = [this] { count(gone_); }}) {}

  bool wait_for(unsigned number) {
    return wait([&] { return revisions_.contains(number); });
  }
  bool wait_for_servers(int count) {
    return wait([&] { return servers_ >= count; });
  }
  bool wait_until_gone() {
    return wait([&] { return gone_ > 0; });
  }
  std::uint64_t revision(unsigned number) {  ///< the last one; 0: none
    const std::lock_guard lock(mutex_);
    return revisions_.contains(number) ? revisions_.at(number) : 0;
  }

 private:
  void add(const Announcement& announcement) {
    const std::lock_guard lock(mutex_);
    revisions_[announcement.distribution_id.bytes[0]] = announcement.revision;
    changed_.notify_all();
  }
  void count(int& number) {
    const std::lock_guard lock(mutex_);
    ++number;
    changed_.notify_all();
  }
  template <typename Predicate>
  bool wait(Predicate predicate) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, predicate);
  }

  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::map<unsigned, std::uint64_t> revisions_;
  int servers_ = 0;
  int gone_ = 0;
  Subscriber<codec::AnnouncementPublication> subscriber_;
};

class SecuredPublication : public testing::Test {
 protected:
  using AdminRequester = Requester<codec::AdminConversation>;

  static std::chrono::sys_seconds now() {
    return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  }
  fs::path add(const security::NewClient& client) const {
    const fs::path out = directory_ / client.name.c_str();
    fleet_.add(client, out, now());
    return out;
  }
  Participant join() const { return Participant({.domain = domain_.number(), .security = alice_}); }
  static std::string tell(AdminRequester& server, const std::string& command,
                          std::chrono::seconds patience = kPatience) {
    AdminRequest request;
    request.argument = command;
    const auto reply = server.call(request, AdminRequester::Clock::now() + patience);
    return reply && !reply->rows.empty() ? reply->rows.front()
           : reply                       ? reply->message
                                         : reply.error().message;
  }

  const test::TemporaryDirectory directory_;
  const test::ReservedDomain domain_;
  const security::SecurityFolder fleet_ =
      security::SecurityFolder::init(directory_ / "fleet", security::kDefaultDays, now());
  const fs::path alice_ = add({.name = "alice", .role = AccessRole::Operator});
  const fs::path record_ = fleet_.clients() / "alice.toml";
  test::ChildProcess server_{
      {KINSHIP_PUBLICATION_SERVER, std::to_string(domain_.number()), directory_ / "fleet"}};
};

TEST_F(SecuredPublication, ALateClientHearsTheNewestEvenIfThatIsPublishedWhileItIsTold) {
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join();
  AdminRequester server(participant, Uuid::random());
  ASSERT_EQ(tell(server, "overtake 1 5"), "done");
  Heard heard(participant);  // is told of 5, and of 6 before that is written
  ASSERT_TRUE(heard.wait_for(1));
  ASSERT_EQ(tell(server, "announce 3 1"), "done");
  ASSERT_TRUE(heard.wait_for(3));  // comes last: whatever else there was has come before
  EXPECT_EQ(heard.revision(1), 6U);
}

TEST_F(SecuredPublication, AClientWhoseRecordComesLaterIsAnsweredAndHears) {
  fs::rename(record_, directory_ / "aside");
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join();
  AdminRequester server(participant, Uuid::random());
  Heard heard(participant);
  ASSERT_NE(tell(server, "announce 1 1", 2s), "done");
  ASSERT_EQ(heard.revision(9), 0U);
  fs::rename(directory_ / "aside", record_);
  EXPECT_EQ(tell(server, "announce 2 1", 10s), "done");
  EXPECT_TRUE(heard.wait_for(9));
}

TEST_F(SecuredPublication, ARevocationTakesWhatIsKeptForLateReadersToo) {
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join();
  Heard heard(participant);
  ASSERT_TRUE(heard.wait_for(9));
  fleet_.revoke("alice", now());
  EXPECT_TRUE(heard.wait_until_gone());
  Heard late(participant);
  AdminRequester server(participant, Uuid::random());
  EXPECT_NE(tell(server, "announce 1 1", 2s), "done");
  EXPECT_EQ(late.revision(9), 0U);
}

TEST_F(SecuredPublication, WhoIsNarrowedHearsNoMoreOfWhatIsKeptThanHeMay) {
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant = join();
  Heard heard(participant);
  ASSERT_TRUE(heard.wait_for(9));
  security::ClientRecord record =
      security::read_record(security::read_file(record_), "record").value_or_throw();
  record.tasks = {"other"};
  security::replace_file(record_, security::record_text(record), security::Readers::Everybody);
  ASSERT_TRUE(heard.wait_for_servers(2));  // a writer for these rights
  Heard late(participant);
  AdminRequester server(participant, Uuid::random());
  ASSERT_TRUE(late.wait_for_servers(1));
  ASSERT_EQ(tell(server, "announce 3 1 other"), "done");
  EXPECT_TRUE(late.wait_for(3));
  EXPECT_EQ(late.revision(9), 0U);
}

TEST_F(SecuredPublication, AWithdrawalIsToldOnlyToWhoMayHearOfIt) {
  const fs::path bob = add({.name = "bob", .role = AccessRole::Operator, .tasks = {"other"}});
  ASSERT_EQ(server_.read_line(), "ready");
  const Participant participant({.domain = domain_.number(), .security = bob});
  AdminRequester server(participant, Uuid::random());
  PublicationTopic type = Wire<codec::AnnouncementPublication>::topic();
  const Entity topic(
      dds_create_topic(participant.get(), &type.type, type.name.c_str(), nullptr, nullptr),
      "topic");
  const Entity subscriber(
      dds_create_subscriber(participant.get(), partition_qos("client_bob").get(), nullptr),
      "subscriber");
  const Entity reader(dds_create_reader(subscriber.get(), topic.get(), type.qos.get(), nullptr),
                      "reader");
  std::map<unsigned, dds_instance_state_t> states;
  const auto hears = [&](unsigned number) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!states.contains(number) && std::chrono::steady_clock::now() < deadline) {
      void* samples[8] = {};
      dds_sample_info_t infos[8];
      const int count = dds_take(reader.get(), samples, infos, 8, 8);
      for (int i = 0; i < count; ++i)
        states[static_cast<const kinship_wire_Announcement*>(samples[i])->distribution_id[0]] =
            infos[i].instance_state;
      if (count > 0)
        dds_return_loan(reader.get(), samples, count);
    }
    return states.contains(number);
  };
  // A writer that does not know the reader yet would not tell it what is withdrawn meanwhile.
  ASSERT_EQ(tell(server, "announce 4 1 other"), "done");
  ASSERT_TRUE(hears(4));
  for (const char* const command :
       {"announce 1 1", "announce 2 1 other", "withdraw 1", "withdraw 2", "announce 3 1 other"})
    ASSERT_EQ(tell(server, command), "done");
  ASSERT_TRUE(hears(3));
  EXPECT_EQ(states[2], DDS_IST_NOT_ALIVE_DISPOSED);
  EXPECT_FALSE(states.contains(1)) << "not even that there was one";
}

}  // namespace
}  // namespace kinship::dds::secured_publication_test
