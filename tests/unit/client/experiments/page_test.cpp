// A page of a small run: real models, files as deploy/quickstart leaves them.

#include "client/experiments/page/page.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "client/experiments/page/page_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::experiments::page_test {
namespace {

constexpr const char* kModels = KINSHIP_SOURCE_DIR "/robots/models";

models::LoadedRobot load(const std::string& name) {
  models::RobotArguments arguments;
  arguments.source = std::filesystem::path(kModels) / name;
  return models::load_robot(arguments).value_or_throw();
}

class Page : public testing::Test {
 protected:
  Page() {
    write_problems("panda", 2);
    write_results("panda", "panda", {700, 900});
    write_problems("ur10e", 2);
    write_results("ur10e", "ur10e-uniform", {4000, 6000});
    write_results("ur10e", "ur10e-guided", {1000, 3000});
    std::ofstream(run_.folder / "distribution.json") << json::to_json(distribution());
    Distribution advised = distribution();
    advised.advice.recommended_share = 0.25;
    advised.advice.evidence = "guided 1 in 2";
    std::ofstream(run_.folder / "advice.json") << json::to_json(advised);
  }

  Problem problem(const std::string& robot, std::size_t number) const {
    const kinematics::Chain chain = load(robot).chain;
    Problem problem;
    problem.name = "p" + std::to_string(number);
    problem.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(0.25, 0, 0));
    problem.start = 0.5 * (chain.lower() + chain.upper());
    problem.goal_configurations = problem.start.array() + 0.4;
    problem.scene.objects = {{"</script><b>", BoxShape{{0.1, 0.2, 0.3}},
                              Eigen::Isometry3d(Eigen::Translation3d(3, 0, 0))}};
    return problem;
  }

  void write_problems(const std::string& robot, std::size_t count) const {
    std::ofstream file(run_.folder / (robot + ".problems.jsonl"));
    for (std::size_t i = 0; i < count; ++i)
      file << json::to_json(problem(robot, i)) << '\n';
  }

  void write_results(const std::string& robot, const std::string& name,
                     const std::vector<std::uint64_t>& checks) const {
    std::ofstream file(run_.folder / (name + ".results.jsonl"));
    for (std::size_t i = 0; i < checks.size(); ++i) {
      const Problem answered = problem(robot, i);
      ProblemResult result;
      result.name = answered.name;
      result.solved = true;
      result.collision_checks = checks[i];
      result.waypoints.emplace(answered.start.size(), 2);
      *result.waypoints << answered.start, answered.goal_configurations;
      file << json::to_json(result) << '\n';
    }
  }

  Distribution distribution() const {
    const kinematics::Chain chain = load("ur10e").chain;
    Distribution distribution;
    distribution.task = "box_to_shelf";
    distribution.robot = chain.digest();
    distribution.profile = "default";
    distribution.configurations = 12'345;
    distribution.limits.resize(2, chain.dof());
    distribution.limits << chain.lower().transpose(), chain.upper().transpose();
    distribution.mixture = Mixture(Eigen::VectorXd::Ones(1), problem("ur10e", 0).start,
                                   {0.01 * Eigen::MatrixXd::Identity(chain.dof(), chain.dof())});
    distribution.sources.emplace_back();
    distribution.sources.back().label = "panda";
    distribution.sources.back().paths = 2;
    return distribution;
  }

  std::string written() const {
    std::ostringstream page;
    write_page(read_run(run_), page);
    return page.str();
  }

  const test::TemporaryDirectory directory_;
  const RunFolder run_{directory_.path(), kModels, {"panda"}, "ur10e"};
};

TEST_F(Page, TellsTheRunsNumbers) {
  const PageData data = read_run(run_);
  ASSERT_EQ(data.fleet.size(), 1U);
  EXPECT_EQ(data.fleet[0].label, "panda");
  EXPECT_EQ(data.fleet[0].problems, 2U);
  EXPECT_EQ(data.fleet[0].paths.size(), 2U);
  EXPECT_GT(data.fleet[0].paths[0].positions.cols(), 2) << "resampled";
  EXPECT_EQ(data.uniform_checks.mean, 5000);
  EXPECT_EQ(data.guided_checks.mean, 2000);
  EXPECT_EQ(data.comparison.mean_checks_ratio, 2.5);
  EXPECT_GT(data.samples.positions.cols(), 1000);
}

TEST_F(Page, EqualFilesGiveAnEqualPage) { EXPECT_EQ(written(), written()); }

TEST_F(Page, CarriesItsDataAsOneDocument) {
  const std::string page = written();
  const std::string begin = "id=\"data\">";
  const auto first = page.find(begin) + begin.size();
  const auto data =
      nlohmann::json::parse(page.substr(first, page.find("</script>", first) - first));
  EXPECT_EQ(data["robot"], "ur10e");
  EXPECT_EQ(data["comparison"]["pairs"], 2);
  EXPECT_EQ(data["uniform_checks"]["mean"], 5000);
  EXPECT_EQ(data["distribution"]["configurations"], 12'345);
  EXPECT_EQ(data["distribution"]["sources"][0]["label"], "panda");
  EXPECT_EQ(data["advice"]["share"], 0.25) << "of now, not of the fetch before the attempts";
  EXPECT_EQ(data["advice"]["evidence"], "guided 1 in 2");
  EXPECT_EQ(data["scene"][0]["name"], "</script><b>");
}

TEST_F(Page, AMissingFileIsNamed) {
  std::filesystem::remove(run_.folder / "distribution.json");
  try {
    read_run(run_);
    FAIL() << "a page without a distribution";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
    EXPECT_NE(std::string(failure.what()).find("distribution.json"), std::string::npos);
  }
}

TEST_F(Page, APathOfAnotherRobotIsRefused) {
  write_results("ur10e", "panda", {1, 1});
  EXPECT_THROW(read_run(run_), Failure);
}

}  // namespace
}  // namespace kinship::experiments::page_test
