// A program that shares nothing with us but the IDL and the contract page, beside a real kinshipd.

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test::foreign_client_test {
namespace {

class ForeignClient : public testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(server_.terminate(), 0); }

  /// \return the lines that a program of the tests writes; it must end well.
  std::vector<std::string> run(const std::string& name, std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.begin(), std::to_string(domain_.number()));
    const Answer answer = run_to_end("../tests/" + name, arguments);
    EXPECT_EQ(answer.code, 0) << name << ": " << answer.err;
    std::vector<std::string> lines;
    std::istringstream stream(answer.out);
    for (std::string line; std::getline(stream, line);)
      lines.push_back(line);
    return lines;
  }

  const ReservedDomain domain_;
  const TemporaryDirectory directory_;
  ServerProcess server_{{.store = directory_ / "fleet.db", .domain = domain_.number()}};
};

TEST_F(ForeignClient, MessagesThatEndEarlyAreRefusedAndHarmNobody) {
  const std::vector<std::string> lines = run("shortened_client");
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "register status=2");
  EXPECT_TRUE(lines[1].starts_with("report status=3 ")) << lines[1];
  EXPECT_EQ(lines[2], "fetch status=5");
  EXPECT_EQ(lines[3], "admin status=2 limit: 0 is not between 1 and 1000");
}

TEST_F(ForeignClient, AMessageThatLiesAboutItsLengthsHarmsNobody) {
  run("hostile_client");
  run("foreign_client");
}

TEST_F(ForeignClient, RegistersReportsFetchesAndHearsOfTheNewerRevision) {
  const std::vector<std::string> lines = run("foreign_client", {"follow"});
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_TRUE(lines[0].starts_with("registered status=0 dof=3 solver=")) << lines[0];
  EXPECT_EQ(lines[1], "reported stored=6");
  EXPECT_TRUE(lines[2].starts_with("fetched revision=1 ")) << lines[2];
  EXPECT_TRUE(lines[2].ends_with(" paths=6")) << lines[2];
  EXPECT_EQ(lines[3], "reported stored=12");
  EXPECT_TRUE(lines[4].starts_with("announced revision=")) << lines[4];
  EXPECT_TRUE(lines[4].ends_with(" task=foreign_sweep")) << lines[4];
  EXPECT_TRUE(lines[5].starts_with("fetched revision=")) << lines[5];
}

}  // namespace
}  // namespace kinship::test::foreign_client_test
