// A study runs through a kinshipd of its own; one of its cells is then repeated with nothing but
// the files it left, `paths import`, `distributions fetch` and `kinship-plan`.

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "client/experiments/pipeline/query_log.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship {
namespace {

const std::string kModels = std::string(KINSHIP_SOURCE_DIR) + "/robots/models";
const std::string kTarget = "planar_7r_c";
const std::string kSource = "planar_5r_b";

class StudyCell : public testing::Test {
 protected:
  std::vector<std::string> study_arguments(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {
        "open_table", "--quick",  "--out",  out_,         "--models",
        kModels,      "--domain", domain(), "--kinshipd", KINSHIP_BIN_DIR "/kinshipd"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  std::string domain() const { return std::to_string(domain_.number()); }

  /// The output of a program that must succeed.
  std::string run(const std::string& program, const std::vector<std::string>& arguments) const {
    test::Program process(program, arguments, directory_ / "messages.txt");
    std::string output = process.read_all();
    EXPECT_EQ(process.wait(), 0) << test::read_text(directory_ / "messages.txt");
    return output;
  }

  std::vector<experiments::QueryResult> study_results() const {
    return experiments::read_query_results(folder_ + "/test.jsonl");
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  const std::string out_ = directory_ / "study";
  const std::string folder_ = out_ + "/open_table-quick";
};

/// Checks by instance of what kinship-plan wrote.
std::map<std::string, std::uint64_t> checks_of(const std::string& lines) {
  std::map<std::string, std::uint64_t> checks;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);) {
    const ProblemResult result = json::problem_result_from_json(line).value_or_throw();
    checks[result.name] = result.collision_checks;
  }
  return checks;
}

TEST_F(StudyCell, CanBeRepeatedByHand) {
  run("kinship-experiments", study_arguments({}));
  EXPECT_NE(test::read_text(folder_ + "/report.html").find("Geometric means"), std::string::npos);
  const std::vector<experiments::QueryResult> results = study_results();
  ASSERT_EQ(results.size(), 3U * 4 * 6);

  const std::string problems = directory_ / "problems.jsonl";
  std::ofstream(problems) << run("kinship-experiments", study_arguments({"--problems", kTarget}));
  const test::ServerProcess server(
      {.store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
  run("kinship",
      {"paths", "import", folder_ + "/learning/" + kSource + ".jsonl", "--domain", domain()});
  const auto plan = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {problems,
                                          "--model",
                                          kModels + "/" + kTarget,
                                          "--domain",
                                          domain(),
                                          "--resolution",
                                          "0.05",
                                          "--overshoot",
                                          "1",
                                          "--max-checks",
                                          "200000",
                                          "--shortcut-checks",
                                          "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return checks_of(run("kinship-plan", arguments));
  };
  const auto uniform = plan({"--guidance", "none"});
  const auto guided = plan({"--task", "open_table", "--guidance", "require", "--sources", kSource,
                            "--share", "1", "--control-share", "0", "--wait", "600"});
  int compared = 0;
  for (const experiments::QueryResult& result : results) {
    if (result.key.robot != kTarget ||
        (result.key.guidance != kSource && result.key.guidance != "uniform"))
      continue;
    const auto& by_hand = result.key.guidance == kSource ? guided : uniform;
    EXPECT_EQ(by_hand.at(result.key.instance), result.checks)
        << result.key.guidance << ", " << result.key.instance;
    ++compared;
  }
  EXPECT_EQ(compared, 12);
}

TEST_F(StudyCell, AFolderIsNotUsedAgainUnasked) {
  std::filesystem::create_directories(folder_);
  test::Program process("kinship-experiments", study_arguments({}), directory_ / "messages.txt");
  EXPECT_EQ(process.wait(), 1);
  EXPECT_NE(test::read_text(directory_ / "messages.txt").find("--resume"), std::string::npos);
}

}  // namespace
}  // namespace kinship
