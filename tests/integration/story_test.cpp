#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "proto/json/problem_json.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test::story_test {
namespace {

namespace fs = std::filesystem;

std::vector<ProblemResult> read_results(const fs::path& file) {
  std::vector<ProblemResult> results;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    results.push_back(json::problem_result_from_json(line).value_or_throw());
  return results;
}

/// Runs deploy/quickstart with two instances per robot. \return its exit code.
int tell_story(const fs::path& folder, std::uint32_t domain) {
  const std::string command =
      std::string("KINSHIP_BIN='") + KINSHIP_BIN_DIR + "' '" + KINSHIP_SOURCE_DIR +
      "/deploy/quickstart' --no-build --fleet 2 --instances 2 --folder '" + folder.string() +
      "' --domain " + std::to_string(domain) + " > '" + folder.string() + ".txt' 2>&1";
  const int status = std::system(command.c_str());  // NOLINT: its arguments are ours
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Story, QuickstartsProgramsTeachANewRobotTwiceInARow) {
  const ReservedDomain domain;
  const TemporaryDirectory temporary;
  const fs::path folder = temporary.path() / "story";
  for (int run = 0; run < 2; ++run) {
    ASSERT_EQ(tell_story(folder, domain.number()), 0) << read_text(folder.string() + ".txt");
    const auto uniform = read_results(folder / "ur10e-uniform.results.jsonl");
    const auto guided = read_results(folder / "ur10e-guided.results.jsonl");
    ASSERT_EQ(uniform.size(), 2U);
    ASSERT_EQ(guided.size(), 2U);
    for (const ProblemResult& result : uniform) {
      EXPECT_EQ(result.sampling_mode, SamplingMode::Control) << result.name;
      EXPECT_EQ(result.share, 0) << result.name;
    }
    for (const ProblemResult& result : guided)
      EXPECT_EQ(result.sampling_mode, SamplingMode::Guided) << result.name;
    EXPECT_NE(read_text(folder / "comparison.txt").find("collision checks, mean"),
              std::string::npos);
    const std::string page = read_text(folder / "quickstart.html");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    const std::string mean_checks =
        std::to_string((uniform[0].collision_checks + uniform[1].collision_checks) / 2);
    EXPECT_NE(page.find("\"uniform_checks\":{\"mean\":" + mean_checks), std::string::npos);
    EXPECT_NE(page.find(guided[0].distribution_id->short_hex()), std::string::npos);
  }
}

TEST(Story, QuickstartLeavesAForeignFolderAlone) {
  const TemporaryDirectory temporary;
  const fs::path folder = temporary.path() / "mine";
  fs::create_directory(folder);
  std::ofstream(folder / "thesis.txt") << "irreplaceable";
  EXPECT_EQ(tell_story(folder, 0), 1);
  EXPECT_EQ(read_text(folder / "thesis.txt"), "irreplaceable");
}

}  // namespace
}  // namespace kinship::test::story_test
