// A study runs through a kinshipd of its own; one of its cells is then repeated with nothing but
// the files it left, `paths import`, `distributions fetch` and `kinship-plan`.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "client/experiments/pipeline/query_log.hpp"
#include "client/experiments/pipeline/server_process.hpp"
#include "client/experiments/pipeline/study_run.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::study_cell_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models";
const std::string kAnalysis = test::source_dir() + "/client/experiments/analyse.py";
const std::string kTarget = "planar_7r_c";
const std::string kSource = "planar_5r_b";

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

/// One cell of a study: how `target` plans with the experience of `source`.
struct RepeatedCell {
  std::string study, target, source;
  std::string resolution;
};

class StudyCell : public testing::Test {
 protected:
  std::vector<std::string> study_arguments(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {
        "open_table", "--quick",  "--out",  out_,         "--models",
        kModels,      "--domain", domain(), "--kinshipd", test::bin_dir() + "/kinshipd",
        "--analysis", kAnalysis};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  std::string domain() const { return std::to_string(domain_.number()); }

  /// The output of a program that must succeed.
  std::string run(const std::string& program, const std::vector<std::string>& arguments) const {
    test::Answer answer = test::run_to_end(program, arguments);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return std::move(answer.out);
  }

  /// Plans the cell, and the same robot uniformly, with the files of the study alone.
  /// \return how many queries had the checks that the study counted; others are failures.
  int repeat_by_hand(const RepeatedCell& cell, const std::string& folder,
                     const std::string& problem_lines) const {
    const std::string problems = directory_ / "problems.jsonl";
    std::ofstream(problems) << problem_lines;
    const test::ServerProcess server(
        {.store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}});
    run("kinship",
        {"paths", "import", folder + "/learning/" + cell.source + ".jsonl", "--domain", domain()});
    const auto plan = [&](std::vector<std::string> more) {
      std::vector<std::string> arguments = {problems,
                                            "--model",
                                            kModels + "/" + cell.target,
                                            "--domain",
                                            domain(),
                                            "--resolution",
                                            cell.resolution,
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
    const auto guided =
        plan({"--task", cell.study, "--guidance", "require", "--sources", cell.source, "--share",
              "1", "--control-share", "0", "--wait", "600", "--rehearsed"});
    int equal = 0;
    for (const auto& result : experiments::read_query_results(folder + "/test.jsonl")) {
      if (result.key.robot != cell.target ||
          (result.key.guidance != cell.source && result.key.guidance != "uniform"))
        continue;
      const auto& by_hand = result.key.guidance == cell.source ? guided : uniform;
      EXPECT_EQ(by_hand.at(result.key.instance), result.checks)
          << result.key.guidance << ", " << result.key.instance;
      equal += by_hand.at(result.key.instance) == result.checks ? 1 : 0;
    }
    return equal;
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  const std::string out_ = directory_ / "study";
  const std::string folder_ = out_ + "/open_table-quick";
};

TEST_F(StudyCell, CanBeRepeatedByHand) {
  run("kinship-experiments", study_arguments({}));
  const std::string report = test::read_text(folder_ + "/RESULTS.md");
  EXPECT_NE(report.find("\n| own | 3 | "), std::string::npos) << report;
  EXPECT_NE(report.find("\n20 learning instances per robot"), std::string::npos) << report;
  EXPECT_NE(test::read_text(folder_ + "/checks.svg").find("<svg "), std::string::npos);
  EXPECT_FALSE(test::read_text(folder_ + "/clouds.png").empty());
  ASSERT_EQ(experiments::read_query_results(folder_ + "/test.jsonl").size(), 3U * 4 * 6);
  const RepeatedCell cell{"open_table", kTarget, kSource, "0.05"};
  EXPECT_EQ(
      repeat_by_hand(cell, folder_,
                     run("kinship-experiments", study_arguments({"--problems", cell.target}))),
      12);
}

// Five cobots take too long for a test; two of them do the same work.
TEST_F(StudyCell, UnderAConstraintCanBeRepeatedByHand) {
  experiments::Study study = experiments::find_study("open_table_cobots");
  study.robots = {study.robots.at(2), study.robots.at(3)};
  study.learning_instances = 8;
  experiments::RunOptions options;
  options.folder = out_;
  options.models = kModels;
  options.kinshipd = test::bin_dir() + "/kinshipd";
  options.domain = domain_.number();
  options.quick = true;
  options.analysis = directory_ / "missing.py";
  std::ostringstream messages, problems;
  experiments::run_study(study, options, messages);
  EXPECT_NE(messages.str().find("to have it done: /usr/bin/python3 " + options.analysis.string() +
                                " " + out_),
            std::string::npos)
      << messages.str();
  const std::string folder = out_ + "/" + study.name + "-quick";
  const auto results = experiments::read_query_results(folder + "/test.jsonl");
  ASSERT_EQ(results.size(), 2U * 3 * 6) << messages.str();
  for (const experiments::QueryResult& result : results) {
    EXPECT_TRUE(result.solved) << result.key.robot << ", " << result.key.instance;
    EXPECT_GT(result.projections, 0U) << "planned without its constraint";
  }
  experiments::write_test_problems(study, options, "panda", problems);
  EXPECT_EQ(repeat_by_hand({study.name, "panda", "ur10e", "0.1"}, folder, problems.str()), 12);
}

// Options are tried, and scenes calibrated, by the tables that follow on standard output.
TEST_F(StudyCell, TuningAndCalibrationEndWithTheirTables) {
  const std::string tuned = run(
      "kinship-experiments",
      study_arguments({"--tuning", "--instances", "2", "--seeds", "1", "--robots", "planar_5r_a",
                       "--sources", "planar_5r_a,others", "--overshoot", "1.5"}));
  EXPECT_TRUE(tuned.starts_with("robot ")) << tuned;
  EXPECT_NE(tuned.find("\nplanar_5r_a    others "), std::string::npos) << tuned;
  EXPECT_NE(tuned.find("\nown          checks "), std::string::npos) << tuned;
  const std::string calibrated =
      run("kinship-experiments", study_arguments({"--resume", "--calibration", "2"}));
  EXPECT_NE(calibrated.find("| planar_7r_c | "), std::string::npos) << calibrated;
}

TEST_F(StudyCell, ARunThatIsKilledTakesItsServerAlong) {
  const experiments::ServerProcess::Options options{test::bin_dir() + "/kinshipd",
                                                    directory_ / "killed.db", domain_.number(), 1};
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const pid_t run = fork();
  if (run == 0) {
    const experiments::ServerProcess server(options);
    const ssize_t told = write(ends[1], "!", 1);
    pause();
    _exit(told == 1 ? 0 : 1);
  }
  char serves = 0;
  ASSERT_EQ(read(ends[0], &serves, 1), 1);
  EXPECT_THROW(experiments::ServerProcess{options}, Failure) << "two servers on one store";
  kill(run, SIGKILL);
  waitpid(run, nullptr, 0);
  close(ends[0]);
  close(ends[1]);
  // The server needs a moment to end; each try takes one.
  constexpr int kTries = 200;
  const auto serves_again = [&] {
    try {
      const experiments::ServerProcess server(options);
      return true;
    } catch (const Failure&) {
      return false;
    }
  };
  int tries = 1;
  while (!serves_again() && tries < kTries)
    ++tries;
  EXPECT_LT(tries, kTries) << test::read_text(directory_ / "killed.db.log");
}

TEST_F(StudyCell, AFolderIsNotUsedAgainUnasked) {
  std::filesystem::create_directories(folder_);
  test::Program process("kinship-experiments", study_arguments({}), directory_ / "messages.txt");
  EXPECT_EQ(process.wait(), 1);
  EXPECT_NE(test::read_text(directory_ / "messages.txt").find("--resume"), std::string::npos);
}

}  // namespace
}  // namespace kinship::study_cell_test
