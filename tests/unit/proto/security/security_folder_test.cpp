#include "proto/security/security_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "proto/security/permissions.hpp"
#include "proto/security/private_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::security {
namespace {

using std::chrono::days;
using std::chrono::sys_seconds;

sys_seconds now_s() {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

unsigned mode_of(const std::filesystem::path& file) {
  struct stat status {};
  EXPECT_EQ(stat(file.c_str(), &status), 0) << file;
  return status.st_mode & 07777U;
}

/// What `act` fails with; nothing if it does not.
template <typename Act>
std::string failure_of(const Act& act) {
  try {
    act();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return {};
}

class SecurityFolderTest : public testing::Test {
 protected:
  SecurityFolder init() { return SecurityFolder::init(folder_, kDefaultDays, now_s()); }

  test::TemporaryDirectory scratch_;
  const std::filesystem::path folder_ = scratch_ / "security";
  const std::filesystem::path out_ = scratch_ / "out";
};

TEST_F(SecurityFolderTest, KeysAreTheOwnersOnly) {
  const SecurityFolder folder = init();
  folder.add({.name = "r1", .role = AccessRole::Robot}, out_, now_s());
  for (const auto& key :
       {folder_ / "authority/ca.key", folder_ / "server/key.pem", out_ / "key.pem"})
    EXPECT_EQ(mode_of(key), 0600U) << key;
  for (const auto& place :
       {folder_, folder_ / "authority", folder_ / "server", folder_ / "clients", out_})
    EXPECT_EQ(mode_of(place), 0700U) << place;
}

TEST_F(SecurityFolderTest, CredentialsOfServerAndClientBelongTogether) {
  const SecurityFolder folder = init();
  folder.add({.name = "r1", .role = AccessRole::Robot}, out_, now_s());
  const auto server = read_credentials(folder_ / "server", now_s());
  ASSERT_TRUE(server) << server.error().message;
  EXPECT_EQ(server->name, "server");
  EXPECT_EQ(server->role, "server");
  const auto client = read_credentials(out_, now_s());
  ASSERT_TRUE(client) << client.error().message;
  EXPECT_EQ(client->name, "r1");
  EXPECT_EQ(client->role, "robot");
  EXPECT_EQ(client->authorities, 1U);
  EXPECT_NEAR(static_cast<double>((client->expires - now_s()).count()), 365 * 86400.0, 60);
}

TEST_F(SecurityFolderTest, NothingThatIsThereIsOverwritten) {
  const SecurityFolder folder = init();
  const std::string key = read_file(folder_ / "authority/ca.key");
  EXPECT_NE(failure_of([&] { init(); }).find("is not empty"), std::string::npos);
  EXPECT_EQ(read_file(folder_ / "authority/ca.key"), key);

  folder.add({.name = "r1"}, out_, now_s());
  EXPECT_NE(failure_of([&] { folder.add({.name = "r2"}, out_, now_s()); }).find("is not empty"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.clients() / "r2.toml"));
  EXPECT_NE(failure_of([&] {
              folder.add({.name = "r1", .role = AccessRole::Admin}, scratch_ / "other", now_s());
            }).find("client 'r1': exists already"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "other"));
}

TEST_F(SecurityFolderTest, WhatCannotBeIsRefusedBeforeAnythingIsWritten) {
  const SecurityFolder folder = init();
  const auto refusal = [&](const NewClient& client) {
    const std::string message = failure_of([&] { folder.add(client, out_, now_s()); });
    EXPECT_FALSE(std::filesystem::exists(out_)) << message;
    return message;
  };
  EXPECT_EQ(refusal({.name = "a b"}), "name 'a b' is not 1 to 56 of letters, digits, _ and -");
  EXPECT_EQ(refusal({.name = "server"}), "name 'server' is the server's own");
  EXPECT_NE(refusal({.name = "r1", .tasks = {"a\"b"}}).find("task pattern"), std::string::npos);
  EXPECT_NE(refusal({.name = "r1", .robots = {"a\nb"}}).find("label"), std::string::npos);
  EXPECT_EQ(refusal({.name = "r1", .days = days(0)}), "days: 0 is not from 1 to 3653");
}

TEST_F(SecurityFolderTest, AFolderThatIsNoneSaysHowToMakeOne) {
  EXPECT_NE(failure_of([&] {
              SecurityFolder{folder_};
            }).find("one is made by: kinshipd secure init " + folder_.string()),
            std::string::npos);
}

TEST_F(SecurityFolderTest, ARevokedClientKeepsItsNameAndGetsNothingNew) {
  const SecurityFolder folder = init();
  folder.add({.name = "r1"}, out_, now_s());
  const auto first = folder.revoke("r1", now_s() - days(1));
  EXPECT_EQ(folder.revoke("r1", now_s()).revoked, first.revoked) << "the first time counts";
  EXPECT_NE(
      failure_of([&] { folder.renew("r1", days(9), scratch_ / "b", now_s()); }).find("revoked"),
      std::string::npos);
  EXPECT_NE(failure_of([&] { folder.add({.name = "r1"}, scratch_ / "b", now_s()); }).find("exists"),
            std::string::npos);
  EXPECT_NE(failure_of([&] { folder.revoke("r9", now_s()); }).find("secure list"),
            std::string::npos);
}

TEST_F(SecurityFolderTest, TheAuthoritysKeyMayBeKeptElsewhere) {
  init();
  const std::filesystem::path kept = scratch_ / "kept.key";
  std::filesystem::rename(folder_ / "authority/ca.key", kept);
  EXPECT_NE(failure_of([&] {
              SecurityFolder(folder_).add({.name = "r1"}, out_, now_s());
            }).find("--authority-key"),
            std::string::npos);
  SecurityFolder(folder_, kept).add({.name = "r1"}, out_, now_s());
  EXPECT_TRUE(read_credentials(out_, now_s()));
}

TEST_F(SecurityFolderTest, CredentialsThatDoNotBelongTogetherAreNamed) {
  const SecurityFolder folder = init();
  folder.add({.name = "r1"}, out_, now_s());
  folder.add({.name = "r2", .role = AccessRole::Admin}, scratch_ / "r2", now_s());
  const auto message = [&] {
    const auto credentials = read_credentials(out_, now_s());
    return credentials ? std::string() : credentials.error().message;
  };
  ASSERT_EQ(message(), "");
  std::filesystem::permissions(out_ / "key.pem", std::filesystem::perms(0640));
  EXPECT_NE(message().find("key.pem: others than its owner"), std::string::npos) << message();
  std::filesystem::copy_file(scratch_ / "r2" / "key.pem", out_ / "key.pem",
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::permissions(out_ / "key.pem", std::filesystem::perms(0600));
  EXPECT_NE(message().find("is not the key of certificate.pem"), std::string::npos) << message();
  for (const std::filesystem::path& other :
       {scratch_ / "none", folder_}) {  // for example the server's folder
    const std::string said = read_credentials(other, now_s()).error().message;
    EXPECT_EQ(said.find(other.string() + ": holds no credentials"), 0U) << said;
    EXPECT_NE(said.find("kinshipd secure add"), std::string::npos) << said;
  }
}

TEST_F(SecurityFolderTest, ThirtyDaysAheadPeopleAreWarned) {
  const SecurityFolder folder = init();
  folder.add({.name = "r1", .days = days(40)}, out_, now_s());
  const auto warning = [&](days later) {
    const Credentials credentials = read_credentials(out_, now_s()).value_or_throw();
    return expiry_warning(credentials, now_s() + later).value_or("");
  };
  EXPECT_EQ(warning(days(9)), "");
  EXPECT_NE(warning(days(12)).find("the credentials of 'r1' expire in 2"), std::string::npos)
      << warning(days(12));
  EXPECT_NE(warning(days(12)).find("kinshipd secure renew r1 --out"), std::string::npos);
  EXPECT_NE(warning(days(41)).find("have expired"), std::string::npos);
  const auto expired = read_credentials(out_, now_s() + days(41));
  ASSERT_FALSE(expired);
  EXPECT_NE(expired.error().message.find("expired at"), std::string::npos);
}

TEST_F(SecurityFolderTest, AClockThatIsBehindIsToldFromACertificateOfTheFuture) {
  init().add({.name = "r1"}, out_, now_s());
  const auto behind = read_credentials(out_, now_s() - days(2));
  ASSERT_FALSE(behind);
  EXPECT_NE(behind.error().message.find("which is behind: it said"), std::string::npos)
      << behind.error().message;
  EXPECT_TRUE(read_credentials(out_, now_s() - std::chrono::hours(23))) << "robots' clocks may be";
  const std::filesystem::path ahead = scratch_ / "ahead";
  SecurityFolder::init(ahead, days(30), now_s() + days(3));
  const auto future = read_credentials(ahead / "server", now_s());
  ASSERT_FALSE(future);
  EXPECT_NE(future.error().message.find("that made the certificate was ahead"), std::string::npos)
      << future.error().message;
}

TEST_F(SecurityFolderTest, TheListHasTheServerEveryClientAndWhatIsUnreadable) {
  const SecurityFolder folder = init();
  folder.add({.name = "b", .tasks = {"shelf_*"}, .days = days(10)}, out_, now_s());
  folder.add({.name = "a", .role = AccessRole::Admin}, scratch_ / "a", now_s());
  folder.revoke("a", now_s());
  write_new_file(folder.clients() / "c.toml", "name = \"c\"\n", Readers::Everybody);
  const CredentialList list = folder.list(now_s());
  ASSERT_EQ(list.credentials.size(), 4U);
  EXPECT_EQ(list.credentials[0].name, "server");
  EXPECT_EQ(list.credentials[0].state, "valid");
  EXPECT_EQ(list.credentials[1].name, "a");
  EXPECT_EQ(list.credentials[1].state, "revoked");
  EXPECT_EQ(list.credentials[2].state, "expires soon");
  EXPECT_EQ(list.credentials[2].tasks, std::vector<std::string>{"shelf_*"});
  EXPECT_EQ(list.credentials[3].state, "unreadable");
  EXPECT_NE(list.credentials[3].message.find("c.toml"), std::string::npos);
  ASSERT_EQ(list.authorities.size(), 1U);
  EXPECT_EQ(list.credentials[2].authority, list.authorities[0].fingerprint);
}

/// What Cyclone DDS's plugins check when two participants meet: each the other's certificate and
/// permissions, with what stands in its own folder.
std::string why_refused(const std::filesystem::path& by, const std::filesystem::path& whom) {
  const CredentialFiles own(by);
  const CredentialFiles other(whom);
  const auto trusted = certificates_from_pem(read_file(own.authorities), "ca.pem");
  const auto certificate = certificates_from_pem(read_file(other.certificate), "certificate.pem");
  if (const auto error = check_issued(*certificate.at(0), trusted, now_s()))
    return error->message;
  const auto permissions = verify_document(read_file(other.permissions), *trusted.at(0));
  return permissions ? std::string() : permissions.error().message;
}

std::string why_not_together(const std::filesystem::path& a, const std::filesystem::path& b) {
  return why_refused(a, b) + why_refused(b, a);
}

TEST_F(SecurityFolderTest, WhileThereAreTwoAuthoritiesFilesOfBothAreAccepted) {
  SecurityFolder folder = init();
  folder.add({.name = "old"}, out_, now_s());
  folder.renew_authority(kDefaultDays, now_s());
  folder.add({.name = "new"}, scratch_ / "new", now_s());
  folder.renew("old", kDefaultDays, scratch_ / "renewed", now_s());

  for (const auto& client : {out_, scratch_ / "new", scratch_ / "renewed"}) {
    EXPECT_EQ(why_not_together(folder.server_credentials(), client), "") << client;
    EXPECT_TRUE(read_credentials(client, now_s())) << client;
  }
  EXPECT_EQ(read_credentials(scratch_ / "new", now_s()).value_or_throw().authorities, 2U);
  EXPECT_TRUE(read_credentials(folder.server_credentials(), now_s()));
}

TEST_F(SecurityFolderTest, ARetiredAuthoritysFilesAreRefusedAndTheNewOnesStayGood) {
  SecurityFolder folder = init();
  folder.add({.name = "old"}, out_, now_s());
  folder.renew_authority(kDefaultDays, now_s());
  folder.add({.name = "new"}, scratch_ / "new", now_s());
  EXPECT_EQ(folder.clients_of_previous_authority(now_s()), std::vector<std::string>{"old"});
  const std::filesystem::path key = folder.retire_authority(kDefaultDays, now_s());

  EXPECT_EQ(mode_of(key), 0600U);
  EXPECT_EQ(why_not_together(folder.server_credentials(), scratch_ / "new"), "");
  EXPECT_NE(why_refused(folder.server_credentials(), out_), "");
  EXPECT_NE(why_refused(out_, folder.server_credentials()), "");
  folder.add({.name = "newest"}, scratch_ / "newest", now_s());
  EXPECT_EQ(why_not_together(folder.server_credentials(), scratch_ / "newest"), "");
}

TEST_F(SecurityFolderTest, AuthoritiesChangeOneAtATime) {
  SecurityFolder folder = init();
  EXPECT_NE(failure_of([&] {
              folder.retire_authority(kDefaultDays, now_s());
            }).find("one authority only"),
            std::string::npos);
  folder.renew_authority(kDefaultDays, now_s());
  EXPECT_NE(failure_of([&] {
              folder.renew_authority(kDefaultDays, now_s());
            }).find("two authorities already"),
            std::string::npos);
}

TEST_F(SecurityFolderTest, AChangeThatStoppedHalfwayGoesOn) {
  SecurityFolder folder = init();
  // As after a stop before the list had the new authority: its key is nobody's.
  write_new_file(folder_ / "authority/next.key", to_pem(*make_key()), Readers::Owner);
  folder.renew_authority(kDefaultDays, now_s());
  // As after a stop before the keys had their names.
  std::filesystem::rename(folder_ / "authority/ca.key", folder_ / "authority/next.key");
  std::filesystem::rename(folder_ / "authority/previous.key", folder_ / "authority/ca.key");
  folder.renew_server(kDefaultDays, now_s());
  folder.add({.name = "new"}, out_, now_s());
  EXPECT_EQ(why_not_together(folder.server_credentials(), out_), "");
}

/// Whether the key of each authority that the folder trusts is still there.
void expect_keys_of_all(const std::filesystem::path& authority) {
  for (const Certificate& one : certificates_from_pem(read_file(authority / "ca.pem"), "ca.pem")) {
    bool is_there = false;
    for (const auto& entry : std::filesystem::directory_iterator(authority))
      if (entry.path().extension() == ".key")
        is_there |= belongs_to(*key_from_pem(read_file(entry.path()), "key"), *one);
    EXPECT_TRUE(is_there) << common_name(*one);
  }
}

TEST_F(SecurityFolderTest, NoChangeThatStoppedHalfwayLosesAKeyInTheNextOne) {
  const std::filesystem::path authority = folder_ / "authority";
  for (const bool is_stopped_between_renames : {false, true}) {
    std::filesystem::remove_all(folder_);
    SecurityFolder folder = init();
    folder.renew_authority(kDefaultDays, now_s());
    std::filesystem::rename(authority / "ca.key", authority / "next.key");
    if (!is_stopped_between_renames)
      std::filesystem::rename(authority / "previous.key", authority / "ca.key");

    const std::filesystem::path retired = folder.retire_authority(kDefaultDays, now_s());
    EXPECT_NE(retired.filename().string().find("retired-"), std::string::npos) << retired;
    expect_keys_of_all(authority);
    folder.renew_authority(kDefaultDays, now_s());
    expect_keys_of_all(authority);
    EXPECT_TRUE(std::filesystem::exists(authority / "ca.key"));
    EXPECT_TRUE(std::filesystem::exists(authority / "previous.key"));
    folder.renew_server(kDefaultDays, now_s());
    EXPECT_EQ(mode_of(authority / "ca.key"), 0600U);
  }
}

TEST_F(SecurityFolderTest, ARetirementThatStoppedHalfwayIsMadeAgain) {
  SecurityFolder folder = init();
  folder.renew_authority(kDefaultDays, now_s());
  const std::string fingerprint = folder.list(now_s()).authorities.at(1).fingerprint;
  const auto kept = folder_ / "authority" / ("retired-" + fingerprint + ".key");
  std::filesystem::rename(folder_ / "authority/previous.key", kept);  // and then it stopped
  EXPECT_EQ(folder.retire_authority(kDefaultDays, now_s()), kept);
  EXPECT_EQ(folder.list(now_s()).authorities.size(), 1U);
}

TEST_F(SecurityFolderTest, ARevocationIsNotUndoneByARenewalBesideIt) {
  constexpr int kClients = 12;
  const SecurityFolder folder = init();
  const auto name = [](int i) { return "r" + std::to_string(i); };
  for (int i = 0; i < kClients; ++i)
    folder.add({.name = name(i)}, scratch_ / name(i).c_str(), now_s());
  for (int i = 0; i < kClients; ++i) {
    const pid_t renewing = fork();
    if (renewing == 0) {  // a process of its own, as secure renew is one
      try {
        SecurityFolder(folder_).renew(name(i), kDefaultDays, scratch_ / ("n" + name(i)).c_str(),
                                      now_s());
      } catch (const Failure&) {  // revoked before
      }
      _exit(0);
    }
    // Within its renewal, mostly: keys and documents take some milliseconds.
    while (!std::filesystem::exists(scratch_ / ("n" + name(i)).c_str()) &&
           waitpid(renewing, nullptr, WNOHANG) == 0)
      std::this_thread::yield();
    folder.revoke(name(i), now_s());
    waitpid(renewing, nullptr, 0);
    EXPECT_TRUE(read_record(read_file(folder.clients() / (name(i) + ".toml")), "record")
                    .value_or_throw()
                    .revoked)
        << i;
  }
}

TEST_F(SecurityFolderTest, TheServersFormerCredentialsAreKept) {
  const SecurityFolder folder = init();
  const std::string key = read_file(folder_ / "server/key.pem");
  const auto kept = folder.renew_server(kDefaultDays, now_s());
  EXPECT_EQ(read_file(kept / "key.pem"), key);
  EXPECT_NE(read_file(folder_ / "server/key.pem"), key);
  EXPECT_NE(folder.renew_server(kDefaultDays, now_s()), kept) << "in the same second";
}

TEST_F(SecurityFolderTest, EachRenewalHasANameOfItsOwnAndTheFormerOnesCanBeRevoked) {
  const SecurityFolder folder = init();
  folder.add({.name = "r1"}, out_, now_s());
  EXPECT_NE(failure_of([&] { folder.revoke_former("r1"); }).find("no former ones"),
            std::string::npos);
  const ClientRecord renewed = folder.renew("r1", days(20), scratch_ / "r1-2", now_s());
  EXPECT_EQ(renewed.generation, 2U);
  EXPECT_EQ(renewed.oldest_accepted, 1U) << "the client need not stop";
  const Credentials credentials = read_credentials(scratch_ / "r1-2", now_s()).value_or_throw();
  EXPECT_EQ(credentials.name, "r1.2");
  EXPECT_NE(expiry_warning(credentials, now_s()).value_or("").find("renew r1 --out"),
            std::string::npos);
  EXPECT_EQ(why_not_together(folder.server_credentials(), scratch_ / "r1-2"), "");
  EXPECT_EQ(folder.revoke_former("r1").oldest_accepted, 2U);
  const ClientRecord again = folder.renew("r1", days(20), scratch_ / "r1-3", now_s());
  EXPECT_EQ(again.generation, 3U);
  EXPECT_EQ(again.oldest_accepted, 2U);
  EXPECT_EQ(folder.list(now_s()).credentials.size(), 2U) << "one client";
}

TEST_F(SecurityFolderTest, ANameLeavesRoomForItsGeneration) {
  const SecurityFolder folder = init();
  const std::string name(56, 'n');
  folder.add({.name = name}, out_, now_s());
  folder.renew(name, days(20), scratch_ / "renewed", now_s());
  EXPECT_EQ(read_credentials(scratch_ / "renewed", now_s())->name, name + ".2");
}

}  // namespace
}  // namespace kinship::security
