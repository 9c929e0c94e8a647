#include "proto/security/client_directory.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/security/private_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::security {
namespace {

using std::chrono::sys_days;
using std::chrono::sys_seconds;
using namespace std::chrono_literals;

const sys_seconds kNow = sys_days(2026y / 11 / 25);

class ClientDirectoryTest : public testing::Test {
 protected:
  void write(const ClientRecord& record) {
    replace_file(folder_ / (record.name + ".toml").c_str(), record_text(record),
                 Readers::Everybody);
  }

  static ClientRecord arm() {
    return {.name = "arm",
            .role = AccessRole::Robot,
            .tasks = {"shelf_*"},
            .serial = "1",
            .authority = "2",
            .expires = kNow + 24h};
  }

  test::TemporaryDirectory folder_;
  std::chrono::steady_clock::time_point clock_;
  ClientDirectory directory_{folder_.path(), [this] { return clock_; }};
};

TEST_F(ClientDirectoryTest, ARecordSaysWhatItsClientMay) {
  write(arm());
  const auto caller = directory_.caller("arm", kNow);
  ASSERT_TRUE(caller) << caller.error().message;
  EXPECT_EQ(caller->name, "arm");
  EXPECT_EQ(caller->client, "arm");
  EXPECT_EQ(caller->role, AccessRole::Robot);
  EXPECT_EQ(caller->tasks, arm().tasks);
  EXPECT_FALSE(caller->is_local);
}

TEST_F(ClientDirectoryTest, WhoHasNoRecordHasNoRights) {
  const auto caller = directory_.caller("arm", kNow);
  ASSERT_FALSE(caller);
  EXPECT_EQ(caller.error().code, ErrorCode::NotFound);
  EXPECT_EQ(caller.error().message, "client 'arm': is not in " + folder_.path().string());
  EXPECT_FALSE(directory_.caller("../arm", kNow));
}

TEST_F(ClientDirectoryTest, ARevocationCountsASecondLater) {
  write(arm());
  ASSERT_TRUE(directory_.caller("arm", kNow));
  ClientRecord revoked = arm();
  revoked.revoked = kNow;
  write(revoked);
  clock_ += 1s;
  const auto caller = directory_.caller("arm", kNow);
  ASSERT_FALSE(caller);
  EXPECT_EQ(caller.error().message, "client 'arm': revoked at 2026-11-25T00:00:00Z");
}

TEST_F(ClientDirectoryTest, CredentialsThatWereReplacedAreRefusedOnceTheFormerOnesAreRevoked) {
  ClientRecord renewed = arm();
  renewed.generation = 3;
  write(renewed);
  for (const char* const name : {"arm", "arm.2", "arm.3"}) {
    const auto caller = directory_.caller(name, kNow);
    ASSERT_TRUE(caller) << name << ": " << caller.error().message;
    EXPECT_EQ(caller->name + " " + caller->client, "arm arm") << "one client, whichever it has";
  }
  renewed.oldest_accepted = 3;
  write(renewed);
  clock_ += 1s;
  EXPECT_TRUE(directory_.caller("arm.3", kNow));
  for (const char* const name : {"arm", "arm.2"})
    EXPECT_FALSE(directory_.caller(name, kNow)) << name;
  EXPECT_EQ(directory_.caller("arm", kNow).error().message,
            "client 'arm': these credentials were replaced (1 of 3), the newest ones are accepted "
            "only");
  for (const char* const name : {"arm.1", "arm.03", "arm.", "arm.3.3"})
    EXPECT_FALSE(directory_.caller(name, kNow)) << name;
}

TEST_F(ClientDirectoryTest, ARecordThatIsPutBackGivesNothingBack) {
  ClientRecord renewed = arm();
  renewed.generation = renewed.oldest_accepted = 2;
  write(renewed);
  ClientRecord other = arm();
  other.name = "leg";
  other.revoked = kNow;
  write(other);
  const auto told = directory_.compare_records();
  ASSERT_EQ(told.unknown.size(), 2U);
  EXPECT_TRUE(told.put_back.empty());
  for (const Revocation& one : told.unknown)
    directory_.remember(one);
  EXPECT_TRUE(directory_.compare_records().unknown.empty()) << "each is told once";

  write(arm());
  other.revoked.reset();
  write(other);
  const auto differences = directory_.compare_records();  // within the second: no clock moved
  EXPECT_TRUE(differences.unknown.empty());
  ASSERT_EQ(differences.put_back.size(), 2U);
  clock_ += 1s;
  EXPECT_EQ(directory_.caller("leg", kNow).error().message,
            "client 'leg': revoked at 2026-11-25T00:00:00Z");
  EXPECT_EQ(directory_.caller("arm", kNow).error().message,
            "client 'arm': these credentials were replaced (1 of 2), the newest ones are accepted "
            "only");
  EXPECT_TRUE(directory_.caller("arm.2", kNow)) << "which were not replaced";
}

TEST_F(ClientDirectoryTest, AClientThatIsAddedIsKnownAndOneThatIsRemovedIsNotASecondLater) {
  ASSERT_FALSE(directory_.find("arm"));
  write(arm());
  EXPECT_TRUE(directory_.find("arm"));
  std::filesystem::remove(folder_ / "arm.toml");
  clock_ += 1s;
  EXPECT_FALSE(directory_.find("arm"));
}

TEST_F(ClientDirectoryTest, NamesThatAreMadeUpPushNobodyOut) {
  write(arm());
  ASSERT_TRUE(directory_.find("arm"));
  for (int i = 0; i < 101'000; ++i)  // more than it has room for
    EXPECT_FALSE(directory_.find("made_up_" + std::to_string(i)));
  replace_file(folder_ / "arm.toml", "name = ", Readers::Everybody);
  EXPECT_TRUE(directory_.find("arm")) << "within its second it is known from memory";
}

TEST_F(ClientDirectoryTest, AnExpiredClientIsRefusedWithItsTime) {
  write(arm());
  const auto caller = directory_.caller("arm", kNow + 24h);
  ASSERT_FALSE(caller);
  EXPECT_EQ(caller.error().message, "client 'arm': expired at 2026-11-26T00:00:00Z");
}

TEST_F(ClientDirectoryTest, ARecordThatIsBrokenOrOfAnotherGivesNoRights) {
  write(arm());
  ASSERT_TRUE(directory_.find("arm"));
  replace_file(folder_ / "arm.toml", "name = ", Readers::Everybody);
  clock_ += 1s;
  EXPECT_FALSE(directory_.find("arm"));
  ClientRecord other = arm();
  other.name = "leg";
  replace_file(folder_ / "arm.toml", record_text(other), Readers::Everybody);
  clock_ += 1s;
  EXPECT_FALSE(directory_.find("arm"));
}

}  // namespace
}  // namespace kinship::security
