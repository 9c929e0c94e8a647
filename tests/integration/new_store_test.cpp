// A store that is deleted and begun anew: it does not get the fleet's old reports and robots by
// itself, they are kept and sent on demand; one that is put back gets what it lost.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::new_store_test {
namespace {

namespace fs = std::filesystem;
using test::Answer;

class NewStore : public testing::Test {
 protected:
  void SetUp() override { setenv("XDG_STATE_HOME", (directory_ / "state").c_str(), 1); }
  void TearDown() override { unsetenv("XDG_STATE_HOME"); }

  void start() {
    server_ = std::make_unique<test::ServerProcess>(
        test::ServerProcess::Options{.store = store(), .domain = domain_.number()});
  }
  void stop() {
    EXPECT_EQ(server_->terminate(), 0);
    server_.reset();
  }
  fs::path store() const { return directory_ / "store" / "fleet.db"; }
  void begin_anew() {
    stop();
    fs::remove_all(store().parent_path());
    fs::create_directory(store().parent_path());
    start();
  }
  std::vector<std::string> with_domain(std::vector<std::string> words) const {
    words.insert(words.end(), {"--domain", std::to_string(domain_.number())});
    return words;
  }
  Answer kinship(const std::string& line) const {
    return test::run_to_end("kinship", with_domain(test::words(line)));
  }
  /// Plans and reports `count` problems of a robot.
  Answer plan(const std::string& robot, int count, const std::vector<std::string>& more = {}) {
    const std::string model = test::source_dir() + "/robots/models/" + robot;
    const std::string problems = directory_.path() / (robot + ".jsonl");
    EXPECT_EQ(test::run_to_end("kinship-experiments", {"shelf", "--model", model, "--count",
                                                       std::to_string(count), "--output", problems})
                  .code,
              0);
    std::vector<std::string> words = {problems,       "--model",    model,       "--task",
                                      "shelf",        "--guidance", "none",      "--report",
                                      "--max-checks", "20000",      "--timeout", "20"};
    words.insert(words.end(), more.begin(), more.end());
    Answer answer = test::run_to_end("kinship-plan", with_domain(words));
    EXPECT_EQ(answer.code, 0) << answer.err;
    return answer;
  }
  /// \return the file of a report that the server put off.
  fs::path set_one_aside() const {
    const fs::path outbox =
        fs::directory_iterator(directory_ / "state" / "kinship" / "outbox")->path();
    const fs::path file = outbox / "set_aside" / "11d0b6f0-3b1c-4b7e-9f2a-0b7de01c5a77.json";
    fs::create_directory(file.parent_path());
    std::ofstream(file) << "{}\n";
    return file;
  }
  std::string attempts() const { return value_of("attempts"); }
  std::string robots() const { return value_of("robots"); }
  /// Of the status, as JSON says it.
  std::string value_of(const std::string& name) const {
    const std::string status = kinship("status --json").out;
    const std::size_t at = status.find("\"" + name + "\":");
    if (at == std::string::npos)
      return status;
    const std::size_t begin = at + name.size() + 3;
    return status.substr(begin, status.find_first_of(",}", begin) - begin);
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  std::unique_ptr<test::ServerProcess> server_;
};

TEST_F(NewStore, GetsTheOldReportsAndRobotsOnDemandAlone) {
  fs::create_directory(store().parent_path());
  start();
  plan("panda", 3);
  EXPECT_EQ(attempts(), "3");
  begin_anew();
  const std::ofstream empty(directory_ / "empty.jsonl");
  const Answer imported = kinship("paths import " + (directory_ / "empty.jsonl").string());
  EXPECT_EQ(imported.code, 0) << imported.err;
  EXPECT_NE(imported.err.find("3 reports of an older store ("), std::string::npos)
      << "before the outbox had the new one: " << imported.err;
  const Answer first = plan("ur10e", 2);
  EXPECT_TRUE(first.says("outbox: 3 reports of an older store (")) << first.err;
  EXPECT_TRUE(first.says("'kinship outbox resend --all'")) << first.err;
  EXPECT_EQ(attempts(), "2");
  EXPECT_EQ(robots(), "1") << "the panda comes with its reports alone";
  const Answer listed = kinship("outbox list");
  EXPECT_TRUE(listed.says("3 reports of this older store")) << listed.out;
  EXPECT_TRUE(kinship("outbox resend").says("3 reports of an older store")) << "which it leaves";

  const fs::path put_away = set_one_aside();
  const Answer again = kinship("outbox resend --all");
  EXPECT_TRUE(again.says("5 reports pending again")) << again.out << again.err;
  EXPECT_TRUE(fs::exists(put_away));
  const Answer second = plan("ur10e", 1);
  EXPECT_FALSE(second.says("older store")) << second.err;
  EXPECT_TRUE(second.says("6 acknowledged, 0 pending, 0 refused")) << second.err;
  EXPECT_EQ(attempts(), "6");
  EXPECT_EQ(robots(), "2");
}

TEST_F(NewStore, IsTakenForOneAtTheFirstRunOrNever) {
  fs::create_directory(store().parent_path());
  start();
  plan("panda", 3);
  begin_anew();
  plan("ur10e", 1, {"--resend", "all"});
  EXPECT_EQ(attempts(), "4");
  begin_anew();
  const Answer none = plan("ur10e", 1, {"--resend", "none"});
  EXPECT_TRUE(none.says("4 reports of an older store")) << none.err;
  EXPECT_EQ(attempts(), "1");
  const fs::path put_away = set_one_aside();
  const Answer away = kinship("outbox drop --all --yes");
  EXPECT_TRUE(away.says("4 reports deleted")) << away.out << away.err;
  EXPECT_TRUE(fs::exists(put_away)) << "no store has acknowledged it";
  EXPECT_FALSE(plan("ur10e", 1).says("older store"));
  EXPECT_EQ(attempts(), "2");
}

TEST_F(NewStore, IsNoneThatWasPutBack) {
  fs::create_directory(store().parent_path());
  start();
  plan("panda", 2);
  stop();
  const fs::path backup = directory_ / "backup.db";
  const Answer saved =
      test::run_to_end("kinshipd", {"backup", "--store", store().string(), backup.string()});
  EXPECT_EQ(saved.code, 0) << saved.err;
  start();
  plan("ur10e", 3);
  begin_anew();  // and regretted
  plan("iiwa14", 1);
  stop();
  const Answer restored =
      test::run_to_end("kinshipd", {"restore", "--store", store().string(), backup.string()});
  EXPECT_EQ(restored.code, 0) << restored.err;
  start();
  EXPECT_EQ(attempts(), "2");
  const Answer planned = plan("iiwa14", 1);
  EXPECT_TRUE(planned.says("1 report of an older store"))
      << "of the one that was regretted: " << planned.err;
  EXPECT_EQ(attempts(), "6") << "five of the store that was put back, and one";
}

TEST_F(NewStore, IsAskedAboutOnATerminal) {
  fs::create_directory(store().parent_path());
  start();
  plan("panda", 2);
  begin_anew();
  plan("ur10e", 1);
  const auto answer_with = [&](const std::string& word) {
    const std::string command =
        test::bin_dir() + "/kinship outbox --domain " + std::to_string(domain_.number());
    return test::run_to_end("/bin/sh",
                            {"-c", "echo " + word + " | script -qec '" + command + "' /dev/null"});
  };
  const Answer left = answer_with("leave");
  EXPECT_TRUE(left.says("[send/delete/leave]")) << left.out;
  EXPECT_TRUE(left.says("They are left there.")) << left.out;
  const fs::path put_away = set_one_aside();
  EXPECT_TRUE(kinship("outbox drop --all").says("2 reports would be deleted"));
  const Answer sent = answer_with("send");
  EXPECT_TRUE(sent.says("3 reports pending again")) << sent.out;
  EXPECT_TRUE(fs::exists(put_away)) << "no store has acknowledged it";
  plan("ur10e", 1);
  EXPECT_EQ(attempts(), "4");
  begin_anew();
  plan("ur10e", 1);
  const Answer deleted = answer_with("delete");
  EXPECT_TRUE(deleted.says("4 reports deleted")) << deleted.out;
  EXPECT_TRUE(fs::exists(put_away)) << "the question was not about it";
  EXPECT_FALSE(kinship("outbox").says("[send/")) << "no terminal, no question";
}

}  // namespace
}  // namespace kinship::new_store_test
