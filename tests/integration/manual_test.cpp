// Manual pages and completions of the real programs, read by the real readers: mandoc, man, bash,
// zsh, fish. Candidates for robots, tasks and distributions come from a real server.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "tests/support/cell.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::manual_test {
namespace {

using Words = std::set<std::string>;

const std::string kBin = test::bin_dir();
const std::string kDrivers = test::source_dir() + "/tests/integration/completion/";
const std::map<std::string, int> kPrograms = {
    {"kinship", 1}, {"kinship-plan", 1}, {"kinship-experiments", 1}, {"kinshipd", 8}};

/// What a command of the shell prints, both streams. \param code  its exit code.
std::string said_by(const std::string& command, int* code = nullptr) {
  std::string text;
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> part{};
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe))
    text.append(part.data(), size);
  const int status = pclose(pipe);
  if (code != nullptr)
    *code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return text;
}

bool is_there(const std::string& program) {
  int code = 1;
  said_by("command -v " + program, &code);
  return code == 0;
}

/// What the programs write about themselves, in a folder.
class Manual : public testing::Test {
 protected:
  void write(const std::string& program, const std::string& option, const std::string& name) {
    int code = -1;
    said_by(kBin + "/" + program + " " + option + " > " + (folder_.path() / name).string(), &code);
    EXPECT_EQ(code, 0) << program << " " << option;
  }

  const test::TemporaryDirectory folder_;
};

TEST_F(Manual, PagesAreAsManWantsThem) {
  if (!is_there("mandoc") || !is_there("man"))
    GTEST_SKIP() << "needs mandoc and man-db (deploy/packages-tests.txt)";
  for (const auto& [program, section] : kPrograms) {
    write(program, "--man-page", program + ".man");
    const std::string page = (folder_.path() / (program + ".man")).string();
    EXPECT_EQ(said_by("mandoc -T lint -W warning " + page), "") << program;
    EXPECT_EQ(said_by("LC_ALL=C man --warnings -l " + page + " > /dev/null"), "") << program;
    const std::string text = said_by("LC_ALL=C MANWIDTH=80 man --nj -l " + page + " | col -bx");
    EXPECT_NE(text.find(program + " - "), std::string::npos) << text.substr(0, 400);
    EXPECT_NE(text.find("--completion bash|zsh|fish"), std::string::npos) << program;
  }
  const std::string text =
      said_by("LC_ALL=C MANWIDTH=80 man -l " + (folder_ / "kinship.man").string() + " | col -b");
  EXPECT_NE(text.find("kinship paths list [OPTIONS]"), std::string::npos);
  EXPECT_NE(text.find("KINSHIP_SERVER"), std::string::npos);
  EXPECT_EQ(text.find("candidates"), std::string::npos) << "is hidden";
}

/// The scripts of all programs for one shell.
class Shells : public Manual, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    if (!is_there(shell_))
      GTEST_SKIP() << "needs " << shell_ << " (deploy/packages-tests.txt)";
    for (const auto& [program, section] : kPrograms)
      write(program, "--completion " + shell_,
            (shell_ == "zsh" ? "_" : "") + program + (shell_ == "fish" ? ".fish" : ""));
  }
  /// What the shell offers at the end of a line.
  /// \param bin  where it finds the programs.
  Words offered(const std::string& line, const std::string& bin = kBin) const {
    const std::string options = shell_ == "bash" ? "--norc" : shell_ == "zsh" ? "-f" : "-N";
    std::istringstream lines(said_by("PATH=" + bin + ":$PATH timeout 60 " + shell_ + " " + options +
                                     " " + kDrivers + "complete." + shell_ + " " +
                                     folder_.path().string() + " '" + line + "'"));
    Words words;
    for (std::string word; std::getline(lines, word);)
      if (!word.empty())
        words.insert(word.substr(0, word.find_last_not_of(' ') + 1));
    return words;
  }

  const std::string shell_ = GetParam();
};

TEST_P(Shells, CompleteVerbsOptionsAndTheirWords) {
  EXPECT_EQ(offered("kinship pa"), (Words{"paths"}));
  EXPECT_EQ(offered("kinship --domain 7 paths "),
            (Words{"list", "show", "export", "import", "plot", "retire", "restore"}));
  EXPECT_EQ(offered("kinship results "), (Words{"compare", "page"}));
  EXPECT_EQ(offered("kinship paths list -o "), (Words{"table", "wide", "json"}));
  const Words options = offered("kinship paths list --");
  for (const char* const option : {"--task", "--robot", "--limit", "--json", "--server"})
    EXPECT_TRUE(options.contains(option)) << option << ": " << testing::PrintToString(options);
  EXPECT_FALSE(options.contains("--file"));
  EXPECT_FALSE(options.contains("--no-wait")) << "is of another verb";
  EXPECT_EQ(offered("kinship-plan --guidance r"), (Words{"require"}));
  EXPECT_TRUE(offered("kinshipd re").contains("restore"));
  EXPECT_TRUE(offered("kinship-experiments pl").contains("placement"));
}

TEST_P(Shells, CompleteFilesWhereFilesAreMeant) {
  std::ofstream(folder_ / "experience.jsonl") << '\n';
  const Words found = offered("kinship paths import " + (folder_ / "exper").string());
  ASSERT_EQ(found.size(), 1U) << testing::PrintToString(found);
  EXPECT_TRUE(found.begin()->ends_with("experience.jsonl")) << *found.begin();
}

TEST_P(Shells, CompleteWhatTheServerKnowsAndNothingWithoutOne) {
  test::Cell cell({.folder = folder_ / "cell"});
  const std::string kinship = "kinship --domain " + std::to_string(cell.domain());
  EXPECT_EQ(offered(kinship + " robots show "), Words());
  cell.start();
  cell.register_model("ur10e");
  cell.report(cell.register_model("panda").robot, 1, 1);
  EXPECT_EQ(offered(kinship + " robots show "), (Words{"panda", "ur10e"}));
  EXPECT_EQ(offered(kinship + " paths list --task "), (Words{"sweep"}));
  EXPECT_EQ(offered(kinship + " paths list --robot u"), (Words{"ur10e"}));
}

TEST_P(Shells, RunNothingThatAServerCallsItsRobots) {
  const std::filesystem::path ran = folder_ / "ran";
  const std::filesystem::path programs = folder_ / "programs";
  std::filesystem::create_directory(programs);
  std::ofstream(programs / "kinship") << "#!/bin/sh\necho 'a$(touch " << ran.string() << ")'\n";
  std::filesystem::permissions(programs / "kinship", std::filesystem::perms::owner_all);
  offered("kinship robots show ", programs.string());
  EXPECT_FALSE(std::filesystem::exists(ran));
}

INSTANTIATE_TEST_SUITE_P(Shell, Shells, testing::Values("bash", "zsh", "fish"),
                         [](const auto& shell) { return std::string(shell.param); });

}  // namespace
}  // namespace kinship::manual_test
