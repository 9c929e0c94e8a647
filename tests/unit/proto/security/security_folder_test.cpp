#include "proto/security/security_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

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

}  // namespace
}  // namespace kinship::security
