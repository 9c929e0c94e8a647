// Robots that get another label or are taken out, with kinship and kinshipd as processes.

#include <gtest/gtest.h>

#include "proto/json/admin_rows_json.hpp"
#include "tests/integration/admin_commands.hpp"

namespace kinship::admin_commands_test {
namespace {

TEST_F(AdminCommands, ALabelIsFreedByARenameAndARobotTakenOutOnlyIfItIsSaidSo) {
  teach(server_);
  const Answer renamed = server_.kinship({"robots", "rename", "panda", "old_panda"});
  ASSERT_EQ(renamed.code, 0) << renamed.err;
  EXPECT_NE(renamed.out.find("is called 'old_panda' now"), std::string::npos) << renamed.out;
  EXPECT_EQ(server_.kinship({"robots", "show", "panda"}).code, 3);
  EXPECT_EQ(server_.kinship({"robots", "rename", "old_panda", "ur10e"}).code, 2);

  const Answer asked = server_.kinship({"robots", "remove", "old_panda"});
  EXPECT_EQ(asked.code, 2);
  EXPECT_NE(asked.err.find("would retire 6 paths"), std::string::npos) << asked.err;
  EXPECT_NE(asked.err.find("7 attempts would stay"), std::string::npos) << asked.err;
  EXPECT_EQ(server_.kinship({"robots", "show", "old_panda"}).code, 0);
  const Answer removed = server_.kinship({"robots", "remove", "old_panda", "--yes", "--json"});
  ASSERT_EQ(removed.code, 0) << removed.err;
  const auto removal = json::row_from_json<RobotRemoval>(removed.out).value_or_throw();
  EXPECT_EQ(removal.paths, 6U);
  EXPECT_EQ(removal.attempts, 7U);
  EXPECT_FALSE(removal.is_deleted);
  EXPECT_EQ(server_.kinship({"robots", "remove", "old_panda"}).code, 3);

  const Answer unused = server_.kinship({"robots", "remove", "ur10e"});
  EXPECT_EQ(unused.code, 0) << unused.err;
  EXPECT_NE(unused.out.find("deleted: it had no attempts"), std::string::npos) << unused.out;
}

TEST_F(AdminCommands, AClientOfARemovedRobotRegistersItAgainAndItsNewReportsCount) {
  teach(server_);
  const auto client = server_.client(folder_ / "outbox");
  ASSERT_EQ(server_.kinship({"robots", "remove", "panda", "--yes"}).code, 0);
  client->report(test::panda_attempt(attempts_.front().robot, "sweep", 1000));
  EXPECT_EQ(client->flush(seconds(60)).accepted, 1U);
  const Answer listed = server_.kinship({"robots", "list", "--json"});
  EXPECT_NE(listed.out.find(R"("paths":1,"attempts":8)"), std::string::npos) << listed.out;
}

}  // namespace
}  // namespace kinship::admin_commands_test
