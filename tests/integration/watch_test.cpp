// What people see of a server while it works: `kinship watch`, and listings as tables.

#include <csignal>
#include <optional>
#include <sstream>
#include <thread>

#include "tests/integration/admin_commands.hpp"

namespace kinship::admin_commands_test {
namespace {

/// `kinship watch` beside what people do.
class Watch : public AdminCommands {
 protected:
  void begin(const std::vector<std::string>& words) {
    watch_.emplace("kinship", words, folder_ / "watch.err");
  }
  /// On the server of the fixture; returns once its first words are there: those of the server.
  void watch(const std::string& options) {
    begin(server_.with_domain("watch " + options));
    wait_for_words("the server is there");
  }
  std::string said() const { return test::read_text(folder_ / "watch.err"); }
  void wait_for_words(const std::string& words) const {
    while (said().find(words) == std::string::npos)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  void end() {
    watch_->signal(SIGINT);
    EXPECT_EQ(watch_->wait(), 0);
  }

  std::optional<test::Program> watch_;
};

TEST_F(Watch, TellsWhatHappensAndThatTheServerGoes) {
  watch("--json --task sweep");
  teach(server_);
  const std::string event = watch_->read_line();
  expect_has(event, "\"kind\":\"report\"");
  server_.process().terminate();
  wait_for_words("the server has gone");
  end();
}

TEST_F(Watch, TellsOfTheExperienceThatSomebodyAskedForAsAFetch) {
  teach(server_);
  watch("--json");
  server_.ends(0, "tasks experience sweep");
  const std::string event = watch_->read_line();
  expect_has(event, "\"kind\":\"fetch\",\"task\":\"sweep\"");
  end();
}

TEST_F(Watch, SaysAtOnceThatThereIsNoServerAndThenHowBusyItIs) {
  const test::ReservedDomain domain;
  begin({"--domain", std::to_string(domain.number()), "watch", "--every", "1", "--robot", "panda"});
  EXPECT_EQ(watch_->read_line().substr(0, 28), "TIME                  KIND  ");
  wait_for_words("no server at 127.0.0.1, domain ");
  const test::ServerProcess late({.store = folder_ / "late.db", .domain = domain.number()});
  const std::string line = watch_->read_line();
  expect_has(line, "  rates       reports 0.0/s, fetches ");
  expect_has(said(), "the server is there");
  end();
}

TEST_F(AdminCommands, ListingsHaveTheNewestFirstInEightyColumns) {
  teach(server_);
  const std::string fetch = "distributions fetch --task sweep --robot panda --wait 120";
  server_.ends(0, fetch + " --placement '0.5 0 0.25 0 0 0 1'");
  server_.ends(0, fetch + " --sources panda --since 90m");
  const std::string table = server_.kinship("distributions list").out;
  const std::string wide = server_.kinship("distributions list -o wide").out;
  const std::size_t newer = wide.find("only panda, since 2"), older = wide.find("0.5 0 0.25 0");
  ASSERT_NE(newer, std::string::npos) << wide;
  ASSERT_NE(older, std::string::npos) << wide;
  EXPECT_LT(newer, older) << wide;
  // Reports under way together may be stored in any order; what follows their receipts, after.
  const auto client = server_.client(folder_ / "newest_outbox");
  const Attempt newest = test::panda_attempt(attempts_.front().robot, "sweep", 100);
  static_cast<void>(client->register_robot(test::model_description("panda")).value_or_throw());
  client->report(newest);
  ASSERT_EQ(client->flush(seconds(60)).accepted, 1U);
  const std::string rows = server_.kinship("paths list -o json").out;
  EXPECT_LT(rows.find(newest.report_uuid.text()), rows.find(attempts_[0].report_uuid.text()));
  const std::string paths = server_.kinship("paths list").out;
  expect_has(paths, attempts_[0].report_uuid.text());
  EXPECT_EQ(paths.find("MACHINE"), std::string::npos) << paths;
  expect_has(server_.ends(0, "paths list -o wide").out, "MACHINE");
  std::istringstream lines(table + paths + server_.kinship("robots list").out +
                           server_.kinship("tasks list").out +
                           server_.kinship("tasks show sweep").out);
  for (std::string line; std::getline(lines, line);)
    EXPECT_LE(line.size(), 80U) << line;
}

TEST_F(Watch, TakesARobotByItsDigestAndTellsNothingOfOthers) {
  teach(server_);
  const std::string panda = attempts_.front().robot.hex().substr(0, 8);
  watch("--json --robot " + panda);
  for (const std::string robot : {"ur10e", "panda"})
    server_.ends(3, "distributions fetch --task dance --robot " + robot);
  const std::string event = watch_->read_line();
  expect_has(event, "\"robot\":\"panda\"");
  end();
}

TEST_F(Watch, SaysThatItDoesNotKnowARobot) {
  watch("--robot nobody");
  expect_has(said(), "no robot 'nobody'");
  end();
}

}  // namespace
}  // namespace kinship::admin_commands_test
