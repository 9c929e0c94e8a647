// kinshipd with its security folder, and clients of every kind as processes and as a library: what
// they may is theirs, and a name that is revoked is refused from then on.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::security_test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

std::chrono::sys_seconds now() {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

class SecuredServer : public testing::Test {
 protected:
  fs::path add(const security::NewClient& client) const {
    const fs::path out = folder_ / client.name.c_str();
    fleet_.add(client, out, now());
    return out;
  }
  link::ClientOptions options(const fs::path& credentials) const {
    link::ClientOptions options;
    options.domain = domain_.number();
    options.security = credentials;
    options.outbox = folder_ / "outbox";
    return options;
  }
  test::Answer kinship(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(),
                     {"--domain", std::to_string(domain_.number()), "--timeout", "1"});
    return test::run_to_end("kinship", arguments);
  }

  const test::TemporaryDirectory folder_;
  const test::ReservedDomain domain_;
  const security::SecurityFolder fleet_ =
      security::SecurityFolder::init(folder_ / "fleet", security::kDefaultDays, now());
  const test::ServerProcess server_{{.store = folder_ / "store.db",
                                     .domain = domain_.number(),
                                     .arguments = {"--security", folder_ / "fleet"}}};
};

TEST_F(SecuredServer, ARobotReportsFetchesAndHearsOfWhatIsNewer) {
  link::Client robot(options(add({.name = "r1"})));
  const Digest panda =
      robot.register_robot(test::model_description("panda")).value_or_throw().robot;
  const auto report = [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      robot.report(test::panda_attempt(panda, "sweep", i));
    const auto left = robot.flush(10s);
    EXPECT_EQ(left.pending + left.refused, 0U);
  };
  report(0, 6);
  FetchRequest request;
  request.task = "sweep";
  request.robot = panda;
  request.deadline = 20s;
  EXPECT_EQ(robot.fetch(request).value_or_throw().status, FetchStatus::Ready);
  const auto followed = robot.follow(request);
  const auto first = followed->wait_for_newer(nullptr, std::chrono::steady_clock::now() + 20s);
  ASSERT_TRUE(first);
  report(100, 112);
  // A refit waits 10 s. Sooner than the lease is renewed, after 20 s: it was announced.
  const auto newer = followed->wait_for_newer(first, std::chrono::steady_clock::now() + 18s);
  EXPECT_GT(newer->revision, first->revision);
  EXPECT_THROW(robot.watch({}), Failure);  // events are not for robots
}

TEST_F(SecuredServer, CommandsNeedCredentials) {
  const fs::path admin = add({.name = "anna", .role = AccessRole::Admin});
  EXPECT_EQ(kinship({"--security", admin, "status"}).code, 0);
  EXPECT_EQ(kinship({"status"}).code, 4);
  setenv("KINSHIP_SECURITY", admin.c_str(), 1);
  EXPECT_EQ(kinship({"robots", "list"}).out, "(none)\n");
  unsetenv("KINSHIP_SECURITY");
  EXPECT_NE(kinship({"--security", folder_ / "fleet", "status"}).code, 0);
  fleet_.revoke("anna", now());
  const auto is_told = [&] { return kinship({"--security", admin, "status"}).says("revoked"); };
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (!is_told())
    ASSERT_LT(std::chrono::steady_clock::now(), end);
}

TEST_F(SecuredServer, FormerCredentialsAreGoodUntilTheyAreRevoked) {
  const fs::path first = add({.name = "anna", .role = AccessRole::Admin});
  const fs::path second = folder_ / "anna-2";
  fleet_.renew("anna", security::kDefaultDays, second, now());
  EXPECT_EQ(kinship({"--security", first, "status"}).code, 0);
  EXPECT_EQ(kinship({"--security", second, "status"}).code, 0);
  fleet_.revoke_former("anna");
  const auto is_told = [&] {
    return kinship({"--security", first, "status"}).says("credentials were replaced (1 of 2)");
  };
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (!is_told())
    ASSERT_LT(std::chrono::steady_clock::now(), end);
  EXPECT_EQ(kinship({"--security", second, "status"}).code, 0);
  EXPECT_EQ(kinship({"--security", second, "tasks", "reset", "none"}).code, 3);
  const test::Answer log = kinship({"--security", second, "audit", "--json"});
  EXPECT_EQ(log.code, 0);
  EXPECT_EQ(log.out.find("anna.2"), std::string::npos) << "one name, whichever credentials";
}

}  // namespace
}  // namespace kinship::security_test
