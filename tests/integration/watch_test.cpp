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
  void watch(std::vector<std::string> words) {
    words.insert(words.begin(), "watch");
    begin(server_.with_domain(words));
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
  watch({"--json", "--task", "sweep"});
  teach(server_);
  const std::string event = watch_->read_line();
  EXPECT_NE(event.find("\"kind\":\"report\""), std::string::npos) << event;
  server_.process().terminate();
  wait_for_words("the server has gone");
  end();
}

TEST_F(Watch, TellsOfTheExperienceThatSomebodyAskedForAsAFetch) {
  teach(server_);
  watch({"--json"});
  EXPECT_EQ(server_.kinship({"tasks", "experience", "sweep"}).code, 0);
  const std::string event = watch_->read_line();
  EXPECT_NE(event.find("\"kind\":\"fetch\",\"task\":\"sweep\""), std::string::npos) << event;
  end();
}

TEST_F(Watch, SaysAtOnceThatThereIsNoServerAndThenHowBusyItIs) {
  const test::ReservedDomain domain;
  begin({"--domain", std::to_string(domain.number()), "watch", "--every", "1", "--robot", "panda"});
  EXPECT_EQ(watch_->read_line().substr(0, 28), "TIME                  KIND  ");
  wait_for_words("no server at 127.0.0.1, domain ");
  const test::ServerProcess late({.store = folder_ / "late.db", .domain = domain.number()});
  const std::string line = watch_->read_line();
  EXPECT_NE(line.find("  rates       reports 0.0/s, fetches "), std::string::npos) << line;
  EXPECT_NE(said().find("the server is there"), std::string::npos);
  end();
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

TEST_F(Watch, TakesARobotByItsDigestAndTellsNothingOfOthers) {
  teach(server_);
  const std::string panda = attempts_.front().robot.hex().substr(0, 8);
  watch({"--json", "--robot", panda});
  for (const std::string robot : {"ur10e", "panda"})
    EXPECT_EQ(server_.kinship({"distributions", "fetch", "--task", "dance", "--robot", robot}).code,
              3);
  const std::string event = watch_->read_line();
  EXPECT_NE(event.find("\"robot\":\"panda\""), std::string::npos) << event;
  end();
}

TEST_F(Watch, SaysThatItDoesNotKnowARobot) {
  watch({"--robot", "nobody"});
  EXPECT_NE(said().find("no robot 'nobody'"), std::string::npos);
  end();
}

}  // namespace
}  // namespace kinship::admin_commands_test
