// What people see of a server while it works: `kinship watch`, and listings as tables.

#include <csignal>
#include <sstream>
#include <thread>

#include "tests/integration/admin_commands.hpp"

namespace kinship::admin_commands_test {
namespace {

TEST_F(AdminCommands, WatchTellsWhatHappensAndThatTheServerGoes) {
  test::Program watch("kinship", server_.with_domain({"watch", "--json", "--task", "sweep"}),
                      folder_ / "watch.err");
  // It watches once its first words are there: those of the server.
  while (test::read_text(folder_ / "watch.err").find("the server is there") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  teach(server_);
  const std::string event = watch.read_line();
  EXPECT_NE(event.find("\"kind\":\"report\""), std::string::npos) << event;
  server_.process().terminate();
  while (test::read_text(folder_ / "watch.err").find("the server has gone") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  watch.signal(SIGINT);
  EXPECT_EQ(watch.wait(), 0);
}

TEST_F(AdminCommands, WatchTellsOfTheExperienceThatSomebodyAskedForAsAFetch) {
  teach(server_);
  test::Program watch("kinship", server_.with_domain({"watch", "--json"}), folder_ / "watch.err");
  while (test::read_text(folder_ / "watch.err").find("the server is there") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(server_.kinship({"tasks", "experience", "sweep"}).code, 0);
  const std::string event = watch.read_line();
  EXPECT_NE(event.find("\"kind\":\"fetch\",\"task\":\"sweep\""), std::string::npos) << event;
  watch.signal(SIGINT);
  EXPECT_EQ(watch.wait(), 0);
}

TEST_F(AdminCommands, WatchSaysAtOnceThatThereIsNoServerAndThenHowBusyItIs) {
  const test::ReservedDomain domain;
  test::Program watch(
      "kinship",
      {"--domain", std::to_string(domain.number()), "watch", "--every", "1", "--robot", "panda"},
      folder_ / "watch.err");
  EXPECT_EQ(watch.read_line().substr(0, 28), "TIME                  KIND  ");
  while (test::read_text(folder_ / "watch.err").find("no server at 127.0.0.1, domain ") ==
         std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const test::ServerProcess late(
      {.store = folder_ / "late.db", .domain = domain.number(), .arguments = {}});
  const std::string line = watch.read_line();
  EXPECT_NE(line.find("  rates       reports 0.0/s, fetches "), std::string::npos) << line;
  EXPECT_NE(test::read_text(folder_ / "watch.err").find("the server is there"), std::string::npos);
  watch.signal(SIGINT);
  EXPECT_EQ(watch.wait(), 0);
}

TEST_F(AdminCommands, ListingsHaveTheNewestFirstInEightyColumns) {
  teach(server_);
  const std::vector<std::string> fetch = {"distributions", "fetch", "--task", "sweep",
                                          "--robot",       "panda", "--wait", "120"};
  const std::vector<std::string> elsewhere = {"--placement", "0.5 0 0.25 0 0 0 1"};
  ASSERT_EQ(server_.kinship(with(fetch, elsewhere)).code, 0);
  ASSERT_EQ(server_.kinship(with(fetch, {"--sources", "panda", "--since", "90m"})).code, 0);
  const std::string table = server_.kinship({"distributions", "list"}).out;
  const std::string wide = server_.kinship({"distributions", "list", "-o", "wide"}).out;
  const std::size_t newer = wide.find("only panda, since 2"), older = wide.find("0.5 0 0.25 0");
  ASSERT_NE(newer, std::string::npos) << wide;
  ASSERT_NE(older, std::string::npos) << wide;
  EXPECT_LT(newer, older) << wide;
  // Reports under way together may be stored in any order; what follows their receipts, after.
  const auto client = server_.client(folder_ / "newest_outbox");
  const Attempt newest = test::panda_attempt(attempts_.front().robot, "sweep", 100);
  client->report(newest);
  ASSERT_EQ(client->flush(seconds(60)).accepted, 1U);
  const std::string rows = server_.kinship({"paths", "list", "-o", "json"}).out;
  EXPECT_LT(rows.find(newest.report_uuid.text()), rows.find(attempts_[0].report_uuid.text()));
  const std::string paths = server_.kinship({"paths", "list"}).out;
  EXPECT_NE(paths.find(attempts_[0].report_uuid.text()), std::string::npos) << paths;
  EXPECT_EQ(paths.find("MACHINE"), std::string::npos) << paths;
  EXPECT_NE(server_.kinship({"paths", "list", "-o", "wide"}).out.find("MACHINE"),
            std::string::npos);
  std::istringstream lines(table + paths + server_.kinship({"robots", "list"}).out +
                           server_.kinship({"tasks", "list"}).out +
                           server_.kinship({"tasks", "show", "sweep"}).out);
  for (std::string line; std::getline(lines, line);)
    EXPECT_LE(line.size(), 80U) << line;
}

TEST_F(AdminCommands, WatchTakesARobotByItsDigestAndTellsNothingOfOthers) {
  teach(server_);
  const std::string panda = attempts_.front().robot.hex().substr(0, 8);
  test::Program watch("kinship", server_.with_domain({"watch", "--json", "--robot", panda}),
                      folder_ / "watch.err");
  while (test::read_text(folder_ / "watch.err").find("the server is there") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  for (const std::string robot : {"ur10e", "panda"})
    EXPECT_EQ(server_.kinship({"distributions", "fetch", "--task", "dance", "--robot", robot}).code,
              3);
  const std::string event = watch.read_line();
  EXPECT_NE(event.find("\"robot\":\"panda\""), std::string::npos) << event;
  watch.signal(SIGINT);
  EXPECT_EQ(watch.wait(), 0);
}

TEST_F(AdminCommands, WatchSaysThatItDoesNotKnowARobot) {
  test::Program watch("kinship", server_.with_domain({"watch", "--robot", "nobody"}),
                      folder_ / "watch.err");
  while (test::read_text(folder_ / "watch.err").find("the server is there") == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_NE(test::read_text(folder_ / "watch.err").find("no robot 'nobody'"), std::string::npos);
  watch.signal(SIGINT);
  EXPECT_EQ(watch.wait(), 0);
}

}  // namespace
}  // namespace kinship::admin_commands_test
