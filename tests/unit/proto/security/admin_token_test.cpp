#include "proto/security/admin_token.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <thread>
#include <vector>

#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::security::admin_token_test {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const Digest kToken{.bytes = {1, 2, 3}};
const Uuid kClient{.bytes = {7}};

class AdminTokenTest : public testing::Test {
 protected:
  std::string proof(const Digest& token = kToken) {
    return prove_admin_token(token, check_.challenge(now_), kClient, request_);
  }
  TokenProof check(const std::string& proof, const std::string& key = "client 1") {
    AdminRequest shown = request_;
    shown.proof = proof;
    return check_.check(shown, kClient, key, now_);
  }

  AdminTokenCheck::TimePoint now_{std::chrono::hours(1)};
  AdminTokenCheck check_{kToken, now_};
  AdminRequest request_{.verb = AdminVerb::ResetTask, .argument = "load"};
};

TEST_F(AdminTokenTest, IsShownByItsProofAlone) {
  EXPECT_EQ(check(""), TokenProof::Missing);
  EXPECT_EQ(check("x"), TokenProof::Wrong);
  EXPECT_EQ(check(std::string(kMaxProofBytes, '0')), TokenProof::Wrong);
  EXPECT_EQ(check(proof({.bytes = {1, 2, 4}})), TokenProof::Wrong);
  EXPECT_EQ(check(proof()), TokenProof::Shown);
  EXPECT_EQ(proof().size(), kMaxProofBytes);
  EXPECT_EQ(proof().find(kToken.hex()), std::string::npos);
}

TEST_F(AdminTokenTest, IsShownForNoOtherRequest) {
  const std::string shown = proof();
  const auto other = [&](auto change) {
    AdminRequest request = request_;
    change(request);
    request.proof = shown;
    return check_.check(request, kClient, "client 1", now_);
  };
  EXPECT_EQ(other([](auto& request) { request.verb = AdminVerb::RemoveRobot; }), TokenProof::Wrong);
  EXPECT_EQ(other([](auto& request) { request.argument = "other"; }), TokenProof::Wrong);
  EXPECT_EQ(other([](auto& request) { request.robot = "r"; }), TokenProof::Wrong);
  EXPECT_EQ(other([](auto& request) { request.task = "t"; }), TokenProof::Wrong);
  EXPECT_EQ(other([](auto& request) { request.cursor = "1"; }), TokenProof::Wrong);
  EXPECT_EQ(other([](auto& request) { request.limit = 7; }), TokenProof::Wrong);
  EXPECT_EQ(other([](auto& request) { request.deadline = seconds(1); }), TokenProof::Wrong);
  AdminRequest request = request_;
  request.proof = shown;
  EXPECT_EQ(check_.check(request, {.bytes = {8}}, "client 1", now_), TokenProof::Wrong)
      << "another sender";
  EXPECT_EQ(check(shown), TokenProof::Shown);
}

TEST_F(AdminTokenTest, ProofsOfCapturedRequestsAreWorthNothing) {
  const std::string captured = proof();
  EXPECT_EQ(check(captured), TokenProof::Shown);
  EXPECT_EQ(check(captured, "attacker 1"), TokenProof::Wrong);
  EXPECT_EQ(check(captured), TokenProof::Shown) << "sent again, as its reply was lost";
  now_ += seconds(61);
  EXPECT_EQ(check(captured), TokenProof::Wrong);
  AdminRequest shown = request_;
  shown.proof = captured;
  EXPECT_EQ(AdminTokenCheck(kToken, now_).check(shown, kClient, "client 1", now_),
            TokenProof::Wrong)
      << "after a restart";
}

TEST_F(AdminTokenTest, ChallengesEnd) {
  const std::string early = proof(), late = proof();
  now_ += minutes(11);
  const std::string now = check_.challenge(now_);
  EXPECT_EQ(check(early), TokenProof::Shown) << "asked for a moment ago, perhaps";
  now_ += minutes(11);
  EXPECT_NE(check_.challenge(now_), now);
  EXPECT_EQ(check(late), TokenProof::Wrong);
}

TEST(AdminTokenFile, IsForItsOwnerAlone) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "new" / "store.db.token";
  EXPECT_THROW(read_admin_token(file), Failure);
  const Digest token = make_admin_token(file);
  struct stat status {};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  EXPECT_EQ(read_admin_token(file), token);
  EXPECT_EQ(make_admin_token(file), token) << "kept";
  std::filesystem::permissions(file, std::filesystem::perms(0640));
  EXPECT_THROW(read_admin_token(file), Failure);
  EXPECT_THROW(make_admin_token(file), Failure);
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  std::ofstream(file) << "none";
  EXPECT_THROW(read_admin_token(file), Failure);
}

TEST(AdminTokenFile, IsAFileOfItsReader) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "token", pipe = directory / "pipe";
  make_admin_token(file);
  const auto fault_of = [](const std::filesystem::path& read) {
    try {
      read_admin_token(read);
      return std::string();
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.code(), ErrorCode::InvalidInput);
      return std::string(failure.what());
    }
  };
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(fault_of(pipe).find("is no file with a token"), std::string::npos);
  EXPECT_NE(fault_of(directory.path()).find("is no file with a token"), std::string::npos);
  EXPECT_EQ(fault_of(file), "");
  if (geteuid() != 0)
    GTEST_SKIP() << "only root can give a file away";
  ASSERT_EQ(chown(file.c_str(), 12'345, 12'345), 0);
  EXPECT_NE(fault_of(file).find("belongs to user 12345"), std::string::npos);
}

TEST(AdminTokenFile, IsOneForServersThatStartAtTheSameTime) {
  for (int round = 0; round < 20; ++round) {
    const test::TemporaryDirectory directory;
    std::vector<Digest> tokens(8);
    {
      std::vector<std::jthread> servers;
      for (Digest& token : tokens)
        servers.emplace_back([&] { token = make_admin_token(directory / "token"); });
    }
    for (const Digest& token : tokens)
      ASSERT_EQ(token, tokens.front());
  }
}

}  // namespace
}  // namespace kinship::security::admin_token_test
