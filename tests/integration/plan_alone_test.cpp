// kinship-plan without a task and without a server: the retreat guides from the robot alone.

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "proto/json/problem_json.hpp"
#include "tests/support/places.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::plan_alone_test {
namespace {

class PlanAlone : public testing::Test {
 protected:
  PlanAlone() {
    const test::Answer made = test::run_to_end(
        "kinship-experiments",
        {"shelf", "--model", model_, "--count", "4", "--output", directory_ / "problems.jsonl"});
    EXPECT_EQ(made.code, 0) << made.err;
  }

  test::Answer plan(std::vector<std::string> more) const {
    more.insert(more.begin(), {directory_ / "problems.jsonl", "--model", model_});
    return test::run_to_end("kinship-plan", more);
  }

  std::vector<ProblemResult> results_of(const test::Answer& answer) const {
    EXPECT_EQ(answer.code, 0) << answer.err;
    std::vector<ProblemResult> results;
    std::istringstream lines(answer.out);
    for (std::string line; std::getline(lines, line);)
      results.push_back(json::problem_result_from_json(line).value_or_throw());
    EXPECT_EQ(results.size(), 4U);
    return results;
  }

  const test::TemporaryDirectory directory_;
  const std::string model_ = test::source_dir() + "/robots/models/panda";
};

TEST_F(PlanAlone, TheRetreatGuidesWithoutTaskAndServer) {
  const test::Answer answer = plan({"--guide", "retreat"});
  std::size_t tracks = 0;
  for (const ProblemResult& result : results_of(answer)) {
    EXPECT_EQ(result.sampling_mode, SamplingMode::Guided) << result.name;
    EXPECT_EQ(result.guide, Guide::Retreat) << result.name;
    EXPECT_EQ(result.guidance_reason, "") << result.name;
    tracks += result.tracks_followed;
  }
  EXPECT_GT(tracks, 0U);
  EXPECT_TRUE(answer.says("guide retreat, which needs no experience; share 1.00\n")) << answer.err;
  EXPECT_FALSE(answer.says("server")) << answer.err;
}

TEST_F(PlanAlone, NoneIsUniformPlanning) {
  const std::vector<ProblemResult> none = results_of(plan({"--guide", "none"}));
  const std::vector<ProblemResult> uniform = results_of(plan({}));
  for (std::size_t i = 0; i < none.size(); ++i) {
    EXPECT_EQ(none[i].sampling_mode, SamplingMode::Uniform);
    EXPECT_EQ(none[i].collision_checks, uniform[i].collision_checks);
  }
}

TEST_F(PlanAlone, StoredWaysNeedATask) {
  const test::Answer answer = plan({"--guide", "ways"});
  EXPECT_EQ(answer.code, 2);
  EXPECT_TRUE(answer.says("--guide: ways needs --task")) << answer.err;
}

}  // namespace
}  // namespace kinship::plan_alone_test
