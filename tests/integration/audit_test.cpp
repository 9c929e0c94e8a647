// Who had what done, and who is served without security: `kinship` and kinshipd as processes.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "proto/json/admin_rows_json.hpp"
#include "tests/integration/admin_commands.hpp"

namespace kinship::admin_commands_test {
namespace {

using Audit = AdminCommands;

/// The oldest first: "verb target outcome".
std::vector<std::string> lines_of(const Answer& audit) {
  std::vector<std::string> lines;
  const nlohmann::json document = nlohmann::json::parse(audit.out);
  for (const auto& row : document.at("rows"))
    lines.insert(lines.begin(), row.at("verb").get<std::string>() + " " +
                                    row.at("target").get<std::string>() + " " +
                                    row.at("outcome").get<std::string>());
  return lines;
}

TEST_F(Audit, WhatAdministratorsDoIsToldAndSurvivesABackupARestartAndARestore) {
  teach(server_);
  const std::string uuid = attempts_[0].report_uuid.text();
  ASSERT_EQ(server_.kinship({"paths", "retire", uuid}).code, 0);
  ASSERT_EQ(server_.kinship({"robots", "rename", "ur10e", "ur10e_2"}).code, 0);
  EXPECT_EQ(server_.kinship({"tasks", "reset", "nothing", "--yes"}).code, 3);
  ASSERT_EQ(server_.kinship({"backup", "copy.db"}).code, 0);
  ASSERT_EQ(server_.kinship({"tasks", "reset", "sweep", "--yes"}).code, 0);
  const std::vector<std::string> done = {
      "retire_path " + uuid + " done", "rename_robot ur10e to ur10e_2 done",
      "reset_task nothing refused",    "backup copy.db begun",
      "backup copy.db done",           "reset_task sweep begun",
      "reset_task sweep done"};
  EXPECT_EQ(lines_of(server_.kinship({"audit", "--json"})), done);

  server_.process().terminate();
  server_.start();
  const Answer table = server_.kinship({"audit", "--since", "90m", "--limit", "2"});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_EQ(count_lines(table.out), 3U) << table.out;
  EXPECT_NE(table.out.find("task 'sweep': 0 paths, 5"), std::string::npos) << table.out;
  for (std::istringstream lines(table.out); lines;) {
    std::string line;
    std::getline(lines, line);
    EXPECT_LE(line.size(), 80U) << line;
  }
  EXPECT_EQ(server_.kinship({"audit", "--since", "2100-01-01"}).out, "(none)\n");
  EXPECT_EQ(server_.kinship({"audit", "--who", "anna"}).out, "(none)\n");
  EXPECT_NE(server_.kinship({"audit", "-o", "wide"}).out.find("task 'sweep': 6 paths"),
            std::string::npos);

  server_.process().terminate();
  test::Program restore("kinshipd", {"restore", "--store", file("store.db"), file("copy.db")},
                        folder_ / "restore.err");
  ASSERT_EQ(restore.wait(), 0);
  server_.start();
  std::vector<std::string> after = done;
  after.push_back("restore " + file("copy.db") + " done");
  EXPECT_EQ(lines_of(server_.kinship({"audit", "--json"})), after);
}

TEST(Insecure, OtherHostsAreServedOnlyIfThatIsSpeltOutAndIsToldAtTheStart) {
  const test::TemporaryDirectory folder;
  const std::string store = (folder / "store.db").string();
  const auto serve = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"--store", store, "--log-level", "off"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_to_end("kinshipd", arguments);
  };
  const Answer refused = serve({"--interface", "nosuch0"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("say --security FOLDER; or say --insecure"), std::string::npos)
      << refused.err;
  // There is no such interface: told what it means, it tries, and says why that fails.
  const Answer told = serve({"--interface", "nosuch0", "--insecure"});
  EXPECT_EQ(told.code, 1);
  EXPECT_NE(told.err.find("kinshipd: --insecure: interface 'nosuch0' is served without security"),
            std::string::npos)
      << told.err;
  EXPECT_NE(told.err.find("does not exist"), std::string::npos) << told.err;
  EXPECT_FALSE(std::filesystem::exists(store));
}

// Robots that get another label or are taken out, with kinship and kinshipd as processes.

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
