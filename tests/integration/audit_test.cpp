// Who had what done: `kinship` and kinshipd as processes.

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
  server_.ends(0, "paths retire " + uuid + " --yes");
  server_.ends(0, "robots rename ur10e ur10e_2");
  server_.ends(3, "tasks reset nothing --yes");
  server_.ends(0, "backup copy.db");
  server_.ends(0, "tasks reset sweep --yes");
  const std::vector<std::string> done = {
      "retire_path " + uuid + " done", "rename_robot ur10e to ur10e_2 done",
      "reset_task nothing refused",    "backup copy.db begun",
      "backup copy.db done",           "reset_task sweep begun",
      "reset_task sweep done"};
  EXPECT_EQ(lines_of(server_.kinship("audit --json")), done);

  server_.process().terminate();
  server_.start();
  const Answer table = server_.ends(0, "audit --since 90m --limit 2");
  EXPECT_EQ(count_lines(table.out), 3U) << table.out;
  expect_has(table.out, "task 'sweep': 0 paths, 5");
  for (std::istringstream lines(table.out); lines;) {
    std::string line;
    std::getline(lines, line);
    EXPECT_LE(line.size(), 80U) << line;
  }
  EXPECT_EQ(server_.kinship("audit --since 2100-01-01").out, "(none)\n");
  EXPECT_EQ(server_.kinship("audit --who anna").out, "(none)\n");
  expect_has(server_.ends(0, "audit -o wide").out, "task 'sweep': 6 paths");

  server_.process().terminate();
  test::Program restore("kinshipd", {"restore", "--store", file("store.db"), file("copy.db")},
                        folder_ / "restore.err");
  ASSERT_EQ(restore.wait(), 0);
  server_.start();
  std::vector<std::string> after = done;
  after.push_back("restore " + file("copy.db") + " done");
  EXPECT_EQ(lines_of(server_.kinship("audit --json")), after);
}

// Robots that get another label or are taken out, with kinship and kinshipd as processes.

TEST_F(AdminCommands, ALabelIsFreedByARenameAndARobotTakenOutOnlyIfItIsSaidSo) {
  teach(server_);
  expect_has(server_.ends(0, "robots rename panda old_panda").out, "is called 'old_panda' now");
  server_.ends(3, "robots show panda");
  server_.ends(2, "robots rename old_panda ur10e");

  const Answer asked = server_.ends(2, "robots remove old_panda");
  expect_has(asked.err, "would retire 6 paths");
  expect_has(asked.err, "7 attempts would stay");
  server_.ends(0, "robots show old_panda");
  const Answer removed = server_.ends(0, "robots remove old_panda --yes --json");
  const auto removal = json::row_from_json<RobotRemoval>(removed.out).value_or_throw();
  EXPECT_EQ(removal.paths, 6U);
  EXPECT_EQ(removal.attempts, 7U);
  EXPECT_FALSE(removal.is_deleted);
  server_.ends(3, "robots remove old_panda");

  expect_has(server_.ends(2, "robots remove ur10e").err, "this would delete 'ur10e'");
  server_.ends(0, "robots show ur10e");
  expect_has(server_.ends(0, "robots remove ur10e --yes").out, "deleted: it had no attempts");
}

TEST_F(AdminCommands, AClientOfARemovedRobotRegistersItAgainAndItsNewReportsCount) {
  teach(server_);
  const auto client = server_.client(folder_ / "outbox");
  server_.ends(0, "robots remove panda --yes");
  client->report(test::panda_attempt(attempts_.front().robot, "sweep", 1000));
  EXPECT_EQ(client->flush(seconds(60)).accepted, 1U);
  const Answer listed = server_.kinship("robots list --json");
  expect_has(listed.out, R"("paths":1,"attempts":8)");
}

}  // namespace
}  // namespace kinship::admin_commands_test
