// The advice is judged: kinship-plan plans both ways, kinshipd compares what it cost.

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "proto/json/problem_json.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

namespace kinship::advice_test {
namespace {

using std::chrono::seconds;

constexpr std::size_t kProblems = 40;
constexpr std::size_t kMisleading = 20;
constexpr double kWall_m = 0.4;  // short enough for uniform planning

struct Counts {
  std::size_t attempts = 0, solved = 0;

  void add(const ProblemResult& result) {
    ++attempts;
    if (result.solved)
      ++solved;
  }
};

class Advised : public testing::Test {
 protected:
  Advised() {
    std::ofstream(urdf_) << description_.urdf;
    std::ofstream problems(problems_);
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> noise(-0.1, 0.1);
    for (std::size_t i = 0; i < kProblems; ++i) {
      Problem problem = guided::test::wall_problem();
      problem.name = "wall " + std::to_string(i);
      problem.seed = i;
      std::get<BoxShape>(problem.scene.objects[0].shape).size.x() = kWall_m;
      problem.time_limit_s = 3600;  // the checks end an attempt, not the machine's load
      for (double& q : problem.start)
        q += noise(generator);
      problems << json::to_json(problem) << '\n';
    }
  }

  void report_path(link::Client& client, const Eigen::MatrixXd& waypoints) const {
    Attempt attempt;
    attempt.report_uuid = Uuid::random();
    attempt.robot = robot_;
    attempt.task = "wall";
    attempt.record.outcome = Outcome::Solved;
    attempt.record.collision_checks = 1;
    attempt.path = Path(waypoints);
    client.report(attempt);
  }

  /// Experience that is of no use for the task: it knows start and goal, so that the gate lets it
  /// pass, and what it knows of the way between leads astray.
  void report_misleading_paths(link::Client& client) const {
    std::mt19937_64 generator(6);
    std::uniform_real_distribution<double> noise(-0.25, 0.25);
    constexpr Eigen::Index kEach = 8;
    const Problem problem = guided::test::wall_problem();
    const Eigen::Vector4d start = problem.start, goal = problem.goal_configurations.col(0);
    const Eigen::Vector4d astray(2.3, 2.3, -2.3, 2.3);
    for (std::size_t i = 0; i < kMisleading; ++i) {
      Eigen::MatrixXd waypoints(4, 3 * kEach);
      waypoints << start.replicate(1, kEach), astray.replicate(1, kEach), goal.replicate(1, kEach);
      for (double& q : waypoints.reshaped())
        q += noise(generator);
      report_path(client, waypoints);
    }
    ASSERT_EQ(client.flush(seconds(60)).accepted, kMisleading);
  }

  std::vector<ProblemResult> plan(const std::string& more) const {
    const test::Answer answer = cell_.run(
        "kinship-plan", problems_ + " " + urdf_ +
                            " --base base --tip l4 --label planar --axes x,y,yaw --task wall" +
                            " --report --outbox " + (directory_ / "plan-outbox").string() +
                            " --wait 120 --max-checks 3000 --transfer '0.3 0 0 0 0 0 1' " + more);
    EXPECT_EQ(answer.code, 0) << answer.err;
    std::vector<ProblemResult> results;
    std::istringstream lines(answer.out);
    for (std::string line; std::getline(lines, line);)
      results.push_back(json::problem_result_from_json(line).value_or_throw());
    return results;
  }

  /// The advice once the server has counted `attempts` of both arms; at most a minute.
  Advice advice_after(link::Client& client, std::size_t attempts) const {
    FetchRequest request;
    request.task = "wall";
    request.robot = robot_;
    request.deadline = seconds(60);
    const auto end = std::chrono::steady_clock::now() + seconds(60);
    while (true) {
      const FetchReply reply = client.fetch(request).value_or_throw();
      if (reply.status != FetchStatus::Ready)
        throw std::runtime_error("no distribution: " + reply.message);
      const Advice& advice = reply.distribution->advice;
      const auto count = [](const std::optional<ModeEvidence>& mode) {
        return mode ? mode->attempts : 0;
      };
      if (count(advice.guided) + count(advice.control) >= attempts ||
          std::chrono::steady_clock::now() > end)
        return advice;
    }
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
  const std::string urdf_ = directory_ / "planar.urdf";
  const std::string problems_ = directory_ / "problems.jsonl";
  const RobotDescription description_ = guided::test::planar_description();
  const Digest robot_ = guided::test::planar_robot().chain.digest();
};

TEST_F(Advised, MisleadingGuidanceLosesItsShareToTheControls) {
  cell_.start();
  link::Client& client = cell_.client();
  ASSERT_TRUE(client.register_robot(description_));
  report_misleading_paths(client);

  Counts guided, control;
  for (const ProblemResult& result :
       plan("--guidance require --guide mixture --control-share 0.5")) {
    ASSERT_TRUE(result.sampling_mode == SamplingMode::Guided ||
                result.sampling_mode == SamplingMode::Control);
    EXPECT_EQ(result.share, result.sampling_mode == SamplingMode::Guided ? 0.9 : 0);
    (result.sampling_mode == SamplingMode::Guided ? guided : control).add(result);
  }
  ASSERT_EQ(guided.attempts + control.attempts, kProblems);
  ASSERT_GE(guided.attempts, 10U);
  ASSERT_GE(control.attempts, 10U);
  EXPECT_LT(guided.solved, guided.attempts) << "unsolved ones belong to the evidence";

  const Advice advice = advice_after(client, kProblems);
  ASSERT_TRUE(advice.guided && advice.control) << advice.evidence;
  EXPECT_EQ(advice.guided->attempts, guided.attempts);
  EXPECT_EQ(advice.guided->solved, guided.solved);
  EXPECT_EQ(advice.control->attempts, control.attempts);
  EXPECT_EQ(advice.control->solved, control.solved);
  EXPECT_EQ(advice.recent.size(), kProblems);
  EXPECT_LT(advice.recommended_share, 0.1) << advice.evidence;
  EXPECT_NE(advice.evidence.find("by processor time"), std::string::npos) << advice.evidence;

  Counts still_guided;
  for (const ProblemResult& result : plan("--guide mixture"))
    if (result.sampling_mode == SamplingMode::Guided)
      still_guided.add(result);
  EXPECT_LT(still_guided.attempts, kProblems / 2) << "each machine goes on from what all know";
}

}  // namespace
}  // namespace kinship::advice_test
