#include <dds/dds.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "proto/codec/conversation.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/wire.hpp"
#include "proto/security/permissions.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/stolen_authority.hpp"
#include "tests/support/temporary_directory.hpp"

/// The authority of a fleet is changed while it works: what Cyclone DDS's own plugins say to files
/// of the previous and of the newer one. Participants are processes of their own, on bare Cyclone
/// DDS.
namespace kinship {
namespace {

using security::SecurityFolder;
using std::chrono::seconds;
using Wire = dds::Wire<codec::FetchConversation>;

/// A participant with the topic of fetches; its process ends if it cannot be.
struct Peer {
  Peer(dds::Role role, std::uint32_t domain, const std::filesystem::path& folder) {
    const std::string configuration = dds::cyclone_configuration({.domain = domain, .role = role});
    if (dds_create_domain(domain, configuration.c_str()) < 0)
      _exit(3);
    participant = dds_create_participant(domain, dds::security_qos(folder).get(), nullptr);
    const auto topics = Wire::topics();
    topic = dds_create_topic(participant, &topics.request, topics.request_topic().c_str(), nullptr,
                             nullptr);
    if (topic < 0)
      _exit(4);
  }

  dds_entity_t participant = 0;
  dds_entity_t topic = 0;
};

/// Writes the client id's first byte of each request that comes into `out`, until it is killed.
[[noreturn]] void serve(std::uint32_t domain, const std::filesystem::path& folder, int out) {
  const Peer peer(dds::Role::Server, domain, folder);
  const dds_entity_t subscriber =
      dds_create_subscriber(peer.participant, dds::partition_qos("client_*").get(), nullptr);
  const dds_entity_t reader =
      dds_create_reader(subscriber, peer.topic, dds::request_reader_qos(64).get(), nullptr);
  const dds_entity_t waitset = dds_create_waitset(peer.participant);
  dds_waitset_attach(waitset, dds_create_readcondition(reader, DDS_ANY_STATE), 0);
  for (;;) {
    dds_attach_t ready = 0;
    dds_waitset_wait(waitset, &ready, 1, DDS_INFINITY);
    void* samples[1] = {nullptr};
    dds_sample_info_t info[1];
    while (dds_take(reader, samples, info, 1, 1) > 0) {
      const auto& request = *static_cast<const Wire::Request*>(samples[0]);
      if (info[0].valid_data && write(out, &request.client_id[0], 1) != 1)
        _exit(5);
      dds_return_loan(reader, samples, 1);
    }
  }
}

/// Sends one request with `mark` as soon as a server is matched.
/// \return as an exit code: whether one was, in time.
int send(std::uint32_t domain, const std::filesystem::path& folder, const std::string& partition,
         std::uint8_t mark, seconds patience) {
  const Peer peer(dds::Role::Client, domain, folder);
  const dds_entity_t publisher =
      dds_create_publisher(peer.participant, dds::partition_qos(partition).get(), nullptr);
  const dds_entity_t writer =
      dds_create_writer(publisher, peer.topic, dds::request_qos().get(), nullptr);
  dds_set_status_mask(writer, DDS_PUBLICATION_MATCHED_STATUS);
  const dds_entity_t waitset = dds_create_waitset(peer.participant);
  dds_waitset_attach(waitset, writer, 0);
  dds_attach_t ready = 0;
  if (dds_waitset_wait(waitset, &ready, 1, DDS_SECS(patience.count())) < 1)
    return 1;
  Wire::Request request{};
  request.client_id[0] = mark;
  std::string task = "t";
  request.task = task.data();
  return dds_write(writer, &request) == 0 && dds_wait_for_acks(writer, DDS_SECS(20)) == 0 ? 0 : 2;
}

class AuthorityChangeTest : public testing::Test {
 protected:
  void TearDown() override { stop(); }

  std::filesystem::path client(const std::string& name) const { return scratch_ / name.c_str(); }

  /// A server, with the credentials that its folder has now.
  void start() { start(folder_.server_credentials()); }
  void start(const std::filesystem::path& credentials) {
    ASSERT_EQ(pipe(pipe_), 0);
    server_ = fork();
    if (server_ == 0)
      serve(domain_.number(), credentials, pipe_[1]);
  }

  void stop() {
    if (server_ <= 0)
      return;
    kill(server_, SIGKILL);
    waitpid(server_, nullptr, 0);
    close(pipe_[0]);
    close(pipe_[1]);
    server_ = 0;
  }

  /// Whether a request of the client reaches the server. It does not if no server is matched, or if
  /// the plugins refuse the client's own files, as they would those of somebody else.
  /// \param partition  empty: its own.
  bool reaches(const std::filesystem::path& credentials, seconds patience = seconds(60),
               std::string partition = {}) {
    if (partition.empty()) {
      const auto file = security::CredentialFiles(credentials).certificate;
      const auto own = security::certificates_from_pem(security::read_file(file), file.string());
      partition = security::client_partition(security::common_name(*own.at(0)));
    }
    const std::uint8_t mark = ++marks_;
    const pid_t sender = fork();
    if (sender == 0)
      _exit(send(domain_.number(), credentials, partition, mark, patience));
    int status = 0;
    waitpid(sender, &status, 0);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 1 || WEXITSTATUS(status) == 4))
          << status;
      return false;
    }
    std::uint8_t got = 0;
    return read(pipe_[0], &got, 1) == 1 && got == mark;
  }

  std::chrono::sys_seconds now() const {
    return std::chrono::floor<seconds>(std::chrono::system_clock::now());
  }

  test::TemporaryDirectory scratch_;
  test::ReservedDomain domain_;
  SecurityFolder folder_ =
      SecurityFolder::init(scratch_ / "security", security::kDefaultDays, now());

 private:
  pid_t server_ = 0;
  int pipe_[2] = {-1, -1};
  std::uint8_t marks_ = 0;
};

TEST_F(AuthorityChangeTest, TheFleetIsServedThroughoutAndThePreviousOnesFilesNotAfterwards) {
  const auto days = security::kDefaultDays;
  folder_.add({.name = "arm"}, client("arm"), now());
  folder_.renew_authority(days, now());
  folder_.renew("arm", days, client("arm-renewed"), now());
  folder_.add({.name = "leg"}, client("leg"), now());

  start();
  EXPECT_TRUE(reaches(client("arm")));
  EXPECT_TRUE(reaches(client("arm-renewed")));
  EXPECT_TRUE(reaches(client("leg")));

  stop();
  folder_.retire_authority(days, now());
  start();
  EXPECT_TRUE(reaches(client("arm-renewed")));
  EXPECT_FALSE(reaches(client("arm"), seconds(3)));
  EXPECT_TRUE(reaches(client("leg")));
}

TEST_F(AuthorityChangeTest, TheRetiredOnesKeySignsNoPermissionsAnyMore) {
  const auto days = security::kDefaultDays;
  folder_.add({.name = "arm"}, client("arm"), now());
  folder_.renew_authority(days, now());
  folder_.renew("arm", days, client("arm-renewed"), now());
  const auto key = folder_.retire_authority(days, now());

  // Who has that key, and every document that was ever sent, wants to be heard as somebody else.
  const test::StolenAuthority thief(key, client("arm"), scratch_.path());
  const auto forged = client("forged");
  std::filesystem::copy(client("arm-renewed"), forged, std::filesystem::copy_options::recursive);
  const security::Validity validity = security::valid_for(days, now());
  std::string permissions = security::client_permissions("leg", AccessRole::Admin, validity);
  const std::string leg = security::subject_text("leg");
  ASSERT_NE(permissions.find(leg), std::string::npos);
  permissions.replace(permissions.find(leg), leg.size(), security::subject_text("arm.2"));
  security::replace_file(security::CredentialFiles(forged).permissions,
                         thief.sign(permissions, validity), security::Readers::Everybody);

  start();
  EXPECT_TRUE(reaches(client("arm-renewed")));
  EXPECT_FALSE(reaches(forged, seconds(3), security::client_partition("leg")));
}

TEST_F(AuthorityChangeTest, TheRetiredOnesKeyMakesNoServerForWhoWasRenewedOnceMore) {
  const auto days = security::kDefaultDays;
  folder_.add({.name = "arm"}, client("arm"), now());
  folder_.renew_authority(days, now());
  folder_.renew("arm", days, client("arm-renewed"), now());
  const auto rogue = client("rogue");  // with the real server's documents, which everybody has seen
  std::filesystem::copy(folder_.server_credentials(), rogue,
                        std::filesystem::copy_options::recursive);
  const auto key = folder_.retire_authority(days, now());
  folder_.renew("arm", days, client("arm-again"), now());
  const test::StolenAuthority thief(key, client("arm"), scratch_.path());
  thief.replace_identity(rogue, security::kServerName, security::valid_for(days, now()));

  start(rogue);
  EXPECT_TRUE(reaches(client("arm-renewed"))) << "why secure list names it";
  EXPECT_FALSE(reaches(client("arm-again"), seconds(3)));
}

}  // namespace
}  // namespace kinship
