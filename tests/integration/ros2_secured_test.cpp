// kinshipd --ros2-enclave and nodes of a keystore of SROS 2, by Cyclone DDS.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::ros2_secured_test {
namespace {

using Words = std::vector<std::string>;

/// A server with certificates of Kinship for its clients, and an enclave for ROS nodes.
class SecuredRos2 : public testing::Test {
 public:
  ~SecuredRos2() override { use_no_enclave(); }

 protected:
  SecuredRos2() {
    make_keystore(keystore_, {"kinship=rt/kinship/*,rr/kinship/*", "arm=*", "onlooker=rt/rosout"});
    EXPECT_EQ(test::run_to_end("kinshipd", {"secure", "init", fleet_}).code, 0);
    EXPECT_EQ(test::run_to_end("kinshipd", {"secure", "add", "anna", "--role", "admin",
                                            "--security", fleet_, "--out", anna_})
                  .code,
              0);
    server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = directory_ / "fleet.db",
        .domain = domain_.number(),
        .arguments = {"--security", fleet_, "--ros2", "--ros2-domain", ros_domain(),
                      "--ros2-enclave", keystore_ + "/enclaves/kinship"}});
  }

  void make_keystore(const std::string& folder, const Words& enclaves) const {
    Words arguments = {folder, ros_domain()};
    arguments.insert(arguments.end(), enclaves.begin(), enclaves.end());
    const test::Answer made =
        test::run_to_end(test::source_dir() + "/tests/integration/ros2/keystore", arguments);
    ASSERT_EQ(made.code, 0) << made.err;
  }

  static void use_enclave(const std::string& keystore, const std::string& name) {
    setenv("ROS_SECURITY_ENABLE", "true", 1);
    setenv("ROS_SECURITY_KEYSTORE", keystore.c_str(), 1);
    setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", name.c_str(), 1);
  }
  static void use_no_enclave() { unsetenv("ROS_SECURITY_ENABLE"); }

  std::string ros_domain() const { return std::to_string(ros_domain_.number()); }

  /// What a node says, or why it has no answer.
  test::Answer run(const std::string& verb, const Words& options) const {
    Words arguments = {ros_domain(), verb};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return test::run_to_end(test::bin_dir() + "/../tests/ros_peer_cyclone", arguments);
  }
  test::Answer register_robot(const std::string& patience) const {
    return run("register", {"urdf=" + test::source_dir() + "/robots/models/ur10e/robot.urdf",
                            "label=arm", "base=base_link", "tip=tool0", "patience=" + patience});
  }

  test::ReservedDomain domain_, ros_domain_;
  test::TemporaryDirectory directory_;
  const std::string keystore_ = directory_ / "keystore", fleet_ = directory_ / "security",
                    anna_ = directory_ / "anna";
  std::unique_ptr<test::ServerProcess> server_;
};

TEST_F(SecuredRos2, NodesOfTheKeystoreAreServedBesideClientsWithCertificates) {
  use_enclave(keystore_, "/arm");
  const Words answer = test::words(register_robot("60").out);
  ASSERT_EQ(answer.size(), 4U);
  EXPECT_EQ(answer[0] + answer[1], "registered0");
  const Words path = {"robot=" + answer[2], "joints=" + answer[3]};
  // 1, a duplicate, where the first answer came before the handshake of its reader was over.
  for (const char* const verb : {"report", "call_report"}) {
    const Words receipt = test::words(run(verb, path).out);
    ASSERT_GE(receipt.size(), 2U) << verb;
    EXPECT_TRUE(receipt[1] == "0" || receipt[1] == "1") << receipt[1];
  }
  const test::Answer robots =
      test::run_to_end("kinship", {"robots", "list", "--domain", std::to_string(domain_.number()),
                                   "--security", anna_, "--timeout", "30"});
  EXPECT_NE(robots.out.find("arm"), std::string::npos) << robots.out << robots.err;
}

TEST_F(SecuredRos2, OthersAreNotHeard) {
  EXPECT_EQ(register_robot("4").out, "no answer\n") << "without security";
  const std::string other = directory_ / "other";
  make_keystore(other, {"arm=*"});
  use_enclave(other, "/arm");
  EXPECT_EQ(register_robot("4").out, "no answer\n") << "of another authority";
  use_enclave(keystore_, "/onlooker");
  EXPECT_EQ(register_robot("4").code, 2) << "may not publish it";
}

TEST_F(SecuredRos2, AnEnclaveThatIsIncompleteOrOfAnotherDomainIsRefusedByName) {
  server_->terminate();
  const auto start = [&](const std::string& domain) {
    return test::run_to_end(
        "kinshipd", {"--store", directory_ / "fleet.db", "--domain",
                     std::to_string(domain_.number()), "--security", fleet_, "--ros2",
                     "--ros2-domain", domain, "--ros2-enclave", keystore_ + "/enclaves/kinship"});
  };
  const test::ReservedDomain unsigned_domain;
  const test::Answer other = start(std::to_string(unsigned_domain.number()));
  EXPECT_NE(other.code, 0);
  EXPECT_NE(other.err.find("Could not find domain " + std::to_string(unsigned_domain.number())),
            std::string::npos)
      << other.err;
  std::filesystem::remove(keystore_ + "/enclaves/kinship/governance.p7s");
  const test::Answer incomplete = start(ros_domain());
  EXPECT_NE(incomplete.code, 0);
  EXPECT_NE(incomplete.err.find("enclaves/kinship/governance.p7s: cannot be read"),
            std::string::npos)
      << incomplete.err;
}

}  // namespace
}  // namespace kinship::ros2_secured_test
