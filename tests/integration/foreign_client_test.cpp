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

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

TEST(ForeignClient, MessagesThatEndEarlyAreRefusedAndHarmNobody) {
  const ReservedDomain domain;
  const TemporaryDirectory directory;
  ServerProcess server({.store = directory / "fleet.db", .domain = domain.number()});
  Program client("../tests/shortened_client", {std::to_string(domain.number())},
                 directory / "error");
  const std::vector<std::string> lines = lines_of(client.read_all());
  ASSERT_EQ(client.wait(), 0) << read_text(directory / "error");
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0], "register status=2");
  EXPECT_TRUE(lines[1].starts_with("report status=3 ")) << lines[1];
  EXPECT_EQ(lines[2], "fetch status=5");
  EXPECT_EQ(lines[3], "admin status=2 limit: 0 is not between 1 and 1000");
  EXPECT_EQ(server.terminate(), 0);
}

TEST(ForeignClient, AMessageThatLiesAboutItsLengthsHarmsNobody) {
  const ReservedDomain domain;
  const TemporaryDirectory directory;
  ServerProcess server({.store = directory / "fleet.db", .domain = domain.number()});
  for (const char* name : {"../tests/hostile_client", "../tests/foreign_client"}) {
    Program client(name, {std::to_string(domain.number())}, directory / "error");
    client.read_all();
    ASSERT_EQ(client.wait(), 0) << name << ": " << read_text(directory / "error");
  }
  EXPECT_EQ(server.terminate(), 0);
}

TEST(ForeignClient, RegistersReportsFetchesAndHearsOfTheNewerRevision) {
  const ReservedDomain domain;
  const TemporaryDirectory directory;
  ServerProcess server({.store = directory / "fleet.db", .domain = domain.number()});
  Program client("../tests/foreign_client", {std::to_string(domain.number()), "follow"},
                 directory / "error");
  const std::vector<std::string> lines = lines_of(client.read_all());
  ASSERT_EQ(client.wait(), 0) << read_text(directory / "error");
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_TRUE(lines[0].starts_with("registered status=0 dof=3 solver=")) << lines[0];
  EXPECT_EQ(lines[1], "reported stored=6");
  EXPECT_TRUE(lines[2].starts_with("fetched revision=1 ")) << lines[2];
  EXPECT_TRUE(lines[2].ends_with(" paths=6")) << lines[2];
  EXPECT_EQ(lines[3], "reported stored=12");
  EXPECT_TRUE(lines[4].starts_with("announced revision=")) << lines[4];
  EXPECT_TRUE(lines[4].ends_with(" task=foreign_sweep")) << lines[4];
  EXPECT_TRUE(lines[5].starts_with("fetched revision=")) << lines[5];
  EXPECT_EQ(server.terminate(), 0);
}

}  // namespace
}  // namespace kinship::test::foreign_client_test
