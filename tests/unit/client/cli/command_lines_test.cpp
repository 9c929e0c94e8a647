// Help, and what is said of a command line that is none.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "proto/types/exit_code.hpp"
#include "tests/unit/client/cli/run_command.hpp"

namespace kinship::cli::command_lines_test {
namespace {

TEST(CommandLines, HelpIsAnAnswer) {
  for (const std::string group : {"robots", "tasks", "paths", "distributions"}) {
    const Answer answer = run_command({group, "list", "--help"});
    EXPECT_EQ(answer.code, kDone);
    EXPECT_NE(answer.out.find("Example:"), std::string::npos) << answer.out;
  }
}

TEST(CommandLines, AMisspeltWordIsAnsweredWithTheNearestOne) {
  const auto error = [](const std::vector<std::string>& words) { return run_command(words).err; };
  EXPECT_NE(error({"robtos"}).find("'robtos' (did you mean 'robots'?)"), std::string::npos);
  EXPECT_NE(error({"paths", "lsit"}).find("'lsit' (did you mean 'list'?)"), std::string::npos)
      << error({"paths", "lsit"});
  EXPECT_NE(error({"paths", "list", "--tsk", "pick"}).find("'--tsk' (did you mean '--task'?)"),
            std::string::npos)
      << error({"paths", "list", "--tsk", "pick"});
  EXPECT_EQ(error({"frobnicate"}).find("did you mean"), std::string::npos);
  EXPECT_NE(error({"paths", "list", "--output", "json"}).find("(did you mean '-o'?)"),
            std::string::npos)
      << error({"paths", "list", "--output", "json"});
}

TEST(CommandLines, AnUnknownOptionIsToldWhateverElseIsWrong) {
  const std::string id = "01234567", robots = "'--robots' (did you mean '--robot'?)";
  const struct {
    std::vector<std::string> words;
    std::string told;
  } lines[] = {
      {{"paths", "export", id, "--robots", "panda", "--task", "pick"}, robots},
      {{"paths", "export", "--task", "pick", id, "--robots=panda"}, "'--robots=panda' (did you"},
      {{"paths", "restore", id, "--robots", "panda", "--task", "pick"}, robots},
      {{"attempts", "list", "--robots", "panda", "--limit", "many"}, robots},
      {{"paths", "import", "a.jsonl", "--robots", "panda", "--ompl-planner-data", "b"}, robots},
      {{"tasks", "list", "--jsn", "--timeout", "abc"}, "'--jsn' (did you mean '--json'?)"},
      {{"status", "--wach", "--timeout", "abc"}, "'--wach'"},
      {{"tasks", "rename", "pick", "--yess"}, "'--yess'"},
  };
  for (const auto& line : lines) {
    const Answer answer = run_command(line.words);
    EXPECT_EQ(answer.code, kWrongUsage);
    EXPECT_TRUE(answer.err.starts_with("kinship: unknown ")) << answer.err;
    EXPECT_NE(answer.err.find(line.told), std::string::npos) << answer.err;
  }
  EXPECT_EQ(run_command({"paths", "list", "--robots", "x", "--help"}).code, kDone);
}

TEST(CommandLines, HelpAndVersionAreWordsToo) {
  EXPECT_EQ(run_command({"help", "paths", "list"}).out,
            run_command({"paths", "list", "--help"}).out);
  EXPECT_EQ(run_command({"help"}).out, run_command({"--help"}).out);
  EXPECT_EQ(run_command({"version"}).out, run_command({"--version"}).out);
  EXPECT_NE(run_command({"version"}).out, "");
  const Answer group = run_command({"paths"});
  EXPECT_EQ(group.code, kWrongUsage);
  EXPECT_NE(group.err.find("  retire "), std::string::npos) << group.err;
}

TEST(CommandLines, TheHelpOfANounIsAboutThatNoun) {
  const Answer answer = run_command({"robots", "--help"});
  EXPECT_EQ(answer.code, kDone);
  EXPECT_EQ(answer.out.find("paths list"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("Exit codes: 0 done"), std::string::npos) << answer.out;
}

TEST(CommandLines, EachHasHelpWithAnExample) {
  const std::vector<std::vector<std::string>> commands = {{"status"},
                                                          {"backup"},
                                                          {"backup", "list"},
                                                          {"backup", "download"},
                                                          {"watch"},
                                                          {"audit"},
                                                          {"jobs", "list"},
                                                          {"jobs", "wait"},
                                                          {"jobs", "cancel"},
                                                          {"robots", "register"},
                                                          {"robots", "rename"},
                                                          {"robots", "remove"},
                                                          {"robots", "init"},
                                                          {"robots", "links"},
                                                          {"robots", "frames"},
                                                          {"robots", "suggest-srdf"},
                                                          {"tasks", "reset"},
                                                          {"tasks", "rename"},
                                                          {"tasks", "remove"},
                                                          {"tasks", "experience"},
                                                          {"paths", "export"},
                                                          {"paths", "import"},
                                                          {"paths", "retire"},
                                                          {"paths", "restore"},
                                                          {"distributions", "fetch"},
                                                          {"distributions", "explain"},
                                                          {"distributions", "evict"},
                                                          {"configurations", "export"}};
  for (std::vector<std::string> command : commands) {
    command.push_back("--help");
    const Answer answer = run_command(command);
    EXPECT_EQ(answer.code, kDone) << command.front();
    EXPECT_NE(answer.out.find("Example"), std::string::npos) << answer.out;
  }
}

}  // namespace
}  // namespace kinship::cli::command_lines_test
