// kinshipd with its security folder, and clients of every kind as processes and as a library: what
// they may is theirs, and a name that is revoked is refused from then on.

#include <cstdlib>

#include "proto/security/private_files.hpp"
#include "tests/integration/secured_site.hpp"

namespace kinship::security_test {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class SecuredServer : public test::SecuredSite {
 protected:
  link::ClientOptions options(const fs::path& credentials) const {
    link::ClientOptions options;
    options.domain = domain_.number();
    options.security = credentials;
    options.outbox = folder_ / "outbox";
    return options;
  }
  test::Answer kinship(const std::string& line) const {
    return test::run_to_end("kinship", test::words("--domain " + std::to_string(domain_.number()) +
                                                   " --timeout 1 " + line));
  }
  /// Waits until somebody with these credentials is told so.
  void wait_until_told(const fs::path& credentials, const std::string& part) const {
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (!kinship("status --security " + credentials.string()).says(part))
      ASSERT_LT(std::chrono::steady_clock::now(), end);
  }

  void wait_for_audit(const std::string& act) const {
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (!kinship("audit --who server --security " + anna_.string()).says(act))
      ASSERT_LT(std::chrono::steady_clock::now(), end);
  }

  test::ServerProcess::Options server_options() const {
    return {.store = folder_ / "store.db",
            .domain = domain_.number(),
            .arguments = {"--security", folder_ / "fleet"}};
  }

  const test::ReservedDomain domain_;
  test::ServerProcess server_{server_options()};
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
  const std::string with_folder = "--security " + (folder_ / "fleet").string();
  EXPECT_EQ(kinship("--security " + anna_.string() + " status").code, 0);
  EXPECT_EQ(kinship("status").code, 4);
  setenv("KINSHIP_SECURITY", anna_.c_str(), 1);
  EXPECT_EQ(kinship("robots list").out, "(none)\n");
  unsetenv("KINSHIP_SECURITY");
  EXPECT_NE(kinship(with_folder + " status").code, 0);
  fleet_.revoke("anna", test::now_s());
  wait_until_told(anna_, "revoked");
}

TEST_F(SecuredServer, FormerCredentialsAreGoodUntilTheyAreRevoked) {
  const fs::path second = folder_ / "anna-2";
  const std::string with_second = "--security " + second.string() + ' ';
  fleet_.renew("anna", security::kDefaultDays, second, test::now_s());
  EXPECT_EQ(kinship("--security " + anna_.string() + " status").code, 0);
  EXPECT_EQ(kinship(with_second + "status").code, 0);
  fleet_.revoke_former("anna");
  wait_until_told(anna_, "credentials were replaced (1 of 2)");
  EXPECT_EQ(kinship(with_second + "status").code, 0);
  EXPECT_EQ(kinship(with_second + "tasks reset none").code, 3);
  const test::Answer log = kinship(with_second + "audit --json");
  EXPECT_EQ(log.code, 0);
  EXPECT_EQ(log.out.find("anna.2"), std::string::npos) << "one name, whichever credentials";
}

TEST_F(SecuredServer, ARevocationOutlivesTheReturnOfItsRecordAndARestart) {
  const fs::path bob = add({.name = "bob", .role = AccessRole::Operator});
  const fs::path record = fleet_.clients() / "bob.toml";
  const std::string of_before = security::read_file(record);
  const auto put_back = [&] {
    security::replace_file(record, of_before, security::Readers::Everybody);
  };
  EXPECT_EQ(kinship("status --security " + bob.string()).code, 0);
  fleet_.revoke("bob", test::now_s());
  wait_until_told(bob, "revoked");
  wait_for_audit("revoke ");
  put_back();
  wait_for_audit("revoke_again");
  EXPECT_TRUE(kinship("status --security " + bob.string()).says("revoked"));
  EXPECT_NE(security::read_file(record).find("revoked = "), std::string::npos)
      << "secure list says so, too";

  server_.kill();
  put_back();
  const test::ServerProcess restarted(server_options());
  const test::Answer refused = kinship("status --security " + bob.string());
  EXPECT_NE(refused.code, 0) << refused.out;
  EXPECT_EQ(kinship("status --security " + anna_.string()).code, 0);
}

}  // namespace
}  // namespace kinship::security_test
