#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "proto/json/problem_json.hpp"
#include "tests/support/places.hpp"
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

/// Runs deploy/quickstart with these options besides. \return its exit code.
int tell_story(const fs::path& folder, std::uint32_t domain, const std::string& options) {
  const std::string command = std::string("KINSHIP_BIN='") + test::bin_dir() + "' '" +
                              test::source_dir() + "/deploy/quickstart' --no-build " + options +
                              " --folder '" + folder.string() + "' --domain " +
                              std::to_string(domain) + " > '" + folder.string() + ".txt' 2>&1";
  const int status = std::system(command.c_str());  // NOLINT: its arguments are ours
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::uint64_t total_checks(const std::vector<ProblemResult>& results) {
  std::uint64_t total = 0;
  for (const ProblemResult& result : results)
    total += result.collision_checks;
  return total;
}

class Story : public testing::Test {
 protected:
  void tell(const std::string& options) {
    ASSERT_EQ(tell_story(folder_, domain_.number(), options), 0) << told();
  }

  std::string told() const { return read_text(folder_.string() + ".txt"); }

  /// Of the new robot: "uniform", "guided" or a guide alone.
  std::vector<ProblemResult> results(const std::string& way) const {
    return read_results(folder_ / ("ur10e-" + way + ".results.jsonl"));
  }

  void expect_both_ways(std::size_t instances) const {
    const auto uniform = results("uniform"), guided = results("guided");
    ASSERT_EQ(uniform.size(), instances);
    ASSERT_EQ(guided.size(), instances);
    for (const ProblemResult& result : uniform) {
      EXPECT_EQ(result.sampling_mode, SamplingMode::Control) << result.name;
      EXPECT_EQ(result.share, 0) << result.name;
    }
    for (const ProblemResult& result : guided)
      EXPECT_EQ(result.sampling_mode, SamplingMode::Guided) << result.name;
  }

  const ReservedDomain domain_;
  const TemporaryDirectory temporary_;
  const fs::path folder_ = temporary_.path() / "story";
};

TEST_F(Story, WhatTwoArmsDidSavesAThirdOneChecks) {
  constexpr std::size_t kInstances = 12;
  tell("--fleet 12 --instances 12 --seed 900");
  expect_both_ways(kInstances);
  EXPECT_LT(total_checks(results("guided")),
            0.8 * static_cast<double>(total_checks(results("uniform"))))
      << told();
  for (const auto& [way, guide] :
       {std::pair("mixture", Guide::Mixture), {"ways", Guide::Ways}, {"retreat", Guide::Retreat}}) {
    const auto alone = results(way);
    EXPECT_EQ(alone.size(), kInstances);
    for (const ProblemResult& result : alone)
      EXPECT_EQ(result.guide, guide) << result.name;
    EXPECT_NE(told().find(std::string("  ") + way + " alone"), std::string::npos) << told();
    EXPECT_FALSE(fs::exists(folder_ / "outbox" / (std::string("ur10e-") + way)))
        << "it is not reported";
  }
  EXPECT_NE(read_text(folder_ / "comparison.txt").find("planning time, mean"), std::string::npos);
}

TEST_F(Story, AnEarlierRunsFolderIsReplacedAndTheShelfIsTheOtherStation) {
  for (const char* const station : {"machine", "shelf"}) {
    tell(std::string("--fleet 2 --instances 2 --station ") + station);
    expect_both_ways(2);
    const auto uniform = results("uniform"), guided = results("guided");
    EXPECT_TRUE(uniform[0].name.starts_with(station)) << uniform[0].name;
    EXPECT_NE(read_text(folder_ / "comparison.txt").find("collision checks, mean"),
              std::string::npos);
    const std::string page = read_text(folder_ / "quickstart.html");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    const std::string mean_checks = std::to_string(total_checks(uniform) / 2);
    EXPECT_NE(page.find("\"uniform_checks\":{\"mean\":" + mean_checks), std::string::npos);
    EXPECT_NE(page.find(guided[0].distribution_id->short_hex()), std::string::npos);
  }
}

TEST(QuickstartsFolder, AForeignOneIsLeftAlone) {
  const TemporaryDirectory temporary;
  const fs::path folder = temporary.path() / "mine";
  fs::create_directory(folder);
  std::ofstream(folder / "thesis.txt") << "irreplaceable";
  EXPECT_EQ(tell_story(folder, 0, ""), 1);
  EXPECT_EQ(read_text(folder / "thesis.txt"), "irreplaceable");
}

}  // namespace
}  // namespace kinship::test::story_test
