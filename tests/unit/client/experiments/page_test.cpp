// A page of a small run: real models, files as deploy/quickstart leaves them.

#include "client/experiments/page/page.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "client/experiments/page/page_data.hpp"
#include "client/experiments/page/page_json.hpp"
#include "client/experiments/page/run_files.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::experiments::page_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models";

models::LoadedRobot load(const std::string& name) {
  models::RobotArguments arguments;
  arguments.source = std::filesystem::path(kModels) / name;
  return models::load_robot(arguments).value_or_throw();
}

/// What find_run or read_run says is wrong.
std::string fault_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "";
}

class Page : public testing::Test {
 protected:
  Page() {
    write_problems("panda", 2);
    write_results("panda", "panda", {700, 900});
    write_problems("ur10e", 2);
    write_results("ur10e", "ur10e-uniform", {4000, 6000});
    write_results("ur10e", "ur10e-guided", {1000, 3000});
    write_searches("ur10e-uniform");
    write_searches("ur10e-guided");
    std::ofstream(folder_ / "distribution.json") << json::to_json(distribution());
    Distribution advised = distribution();
    advised.advice.recommended_share = 0.25;
    advised.advice.evidence = "guided 1 in 2";
    std::ofstream(folder_ / "advice.json") << json::to_json(advised);
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
    AttachedObject box;
    box.name = "box";
    box.link = chain.tip_link();
    box.shape = BoxShape{{0.05, 0.05, 0.1}};
    box.T_link_object = Eigen::Translation3d(0, 0, 0.1);
    problem.attached = {box};
    return problem;
  }

  void write_problems(const std::string& robot, std::size_t count) const {
    std::ofstream file(folder_ / (robot + ".problems.jsonl"));
    for (std::size_t i = 0; i < count; ++i)
      file << json::to_json(problem(robot, i)) << '\n';
  }

  void write_results(const std::string& robot, const std::string& name,
                     const std::vector<std::uint64_t>& checks) const {
    std::ofstream file(folder_ / (name + ".results.jsonl"));
    for (std::size_t i = 0; i < checks.size(); ++i) {
      const Problem answered = problem(robot, i);
      ProblemResult result;
      result.name = answered.name;
      result.solved = true;
      result.guide = Guide::Ways;
      result.experience_revision = 1;
      result.collision_checks = checks[i];
      result.planning_time_s = 1e-6 * static_cast<double>(checks[i]);
      result.waypoints.emplace(answered.start.size(), 2);
      *result.waypoints << answered.start, answered.goal_configurations;
      file << json::to_json(result) << '\n';
    }
  }

  /// Of the first problem: a start, a goal and a node between them.
  void write_searches(const std::string& name) const {
    const Problem answered = problem("ur10e", 0);
    RecordedSearch search;
    search.name = answered.name;
    search.nodes.resize(answered.start.size(), 4);
    const Eigen::VectorXd goal = answered.goal_configurations.col(0);
    search.nodes << answered.start, goal, 0.5 * (answered.start + goal), goal;
    search.parents = {-1, -1, 0, 2};
    search.checks = {1, 2, 500, 1000};
    search.path = {0, 2, 3, 1};
    std::ofstream(folder_ / (name + ".searches.jsonl")) << json::to_json(search) << '\n';
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
    write_page(read_run(run()), page);
    return page.str();
  }

  RunFiles run() const {
    RunLocation location;
    location.folder = folder_;
    location.models = kModels;
    return find_run(location);
  }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path folder_ = directory_.path();
};

TEST_F(Page, TellsTheRunsNumbers) {
  const PageData data = read_run(run());
  ASSERT_EQ(data.fleet.size(), 1U);
  EXPECT_EQ(data.fleet[0].label, "panda");
  EXPECT_EQ(data.fleet[0].problems, 2U);
  EXPECT_EQ(data.fleet[0].paths.size(), 2U);
  EXPECT_GT(data.fleet[0].paths[0].positions.cols(), 2) << "resampled";
  EXPECT_EQ(data.figures["uniform_checks"]["mean"], 5000);
  EXPECT_EQ(data.figures["guided_checks"]["mean"], 2000);
  EXPECT_EQ(data.figures["cheaper_guided"], 2);
  EXPECT_EQ(data.figures["comparison"]["ratio"]["mean_checks"], 2.5);
  EXPECT_GT(data.samples.hand.positions.cols(), 1000);
}

TEST_F(Page, ARobotAndItsBoxGoFromStartToGoal) {
  const PageData data = read_run(run());
  ASSERT_TRUE(data.newcomer);
  const Demonstration& shown = *data.newcomer;
  const models::LoadedRobot robot = load("ur10e");
  const Problem answered = problem("ur10e", 0);
  ASSERT_GT(shown.frames.size(), 5U);
  EXPECT_EQ(shown.obstacles.size(), answered.scene.objects.size());
  const auto held_at = [&](const Eigen::VectorXd& q) {
    return page::held_objects(robot, answered.attached, *answered.T_task_base, q)
        .front()
        .T_task_object;
  };
  EXPECT_TRUE(shown.frames.front().held.front().T_task_object.isApprox(held_at(answered.start)));
  EXPECT_TRUE(shown.frames.back().held.front().T_task_object.isApprox(
      held_at(answered.goal_configurations.col(0))));
}

TEST_F(Page, ShowsTheSearchesOfTheInstanceNearestTheMedianRatio) {
  const PageData data = read_run(run());  // ratios 4 and 2: the median is 3, the first of equals
  ASSERT_TRUE(data.searches);
  const nlohmann::ordered_json& typical = data.figures["typical"];
  EXPECT_EQ(typical["problem"], "p0");
  EXPECT_EQ(typical["median_ratio"], 3);
  EXPECT_EQ(typical["candidates"], 2);
  EXPECT_EQ(typical["uniform_checks"], 4000);
  EXPECT_EQ(data.searches->guided.path, (std::vector<std::int64_t>{0, 2, 3, 1}));
  const models::LoadedRobot robot = load("ur10e");
  EXPECT_TRUE(data.searches->uniform.hand.col(0).isApprox(
      poses_of(robot.chain, *problem("ur10e", 0).T_task_base, problem("ur10e", 0).start)
          .positions.col(0)));
}

TEST_F(Page, GoesWithoutWhatARunNeedNotHave) {
  for (const char* name : {"advice.json", "ur10e-uniform.searches.jsonl", "panda.results.jsonl"})
    std::filesystem::remove(folder_ / name);
  const PageData data = read_run(run());
  EXPECT_FALSE(data.advice || data.searches);
  EXPECT_TRUE(data.fleet.empty());
  EXPECT_TRUE(data.newcomer);
}

TEST_F(Page, TellsWhatEachGuideAloneBringsBesideIt) {
  write_results("ur10e", "ur10e-retreat", {8000, 12000});
  write_results("ur10e", "ur10e-mixture", {1000, 1000});
  const PageData data = read_run(run());
  EXPECT_EQ(data.fleet.size(), 1U) << "they are no teachers";
  const auto told = nlohmann::json::parse(to_json(data))["also"];
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0][0], "mixture alone");
  EXPECT_EQ(told[0][3], "5.00");
  EXPECT_EQ(told[1], (std::vector<std::string>{"retreat alone", "2/2", "10 000", "0.50", "10.0 ms",
                                               "0.50"}));
}

TEST_F(Page, ResultsBesideItMayHaveAnyName) {
  write_results("ur10e", "tuned", {500, 1500});
  RunLocation location;
  location.folder = folder_;
  location.models = kModels;
  location.files.also = {
      parse_also("with my option=" + (folder_ / "tuned.results.jsonl").string())};
  const PageData data = read_run(find_run(location));
  ASSERT_EQ(data.figures["also"].size(), 1U);
  EXPECT_EQ(data.figures["also"][0][0], "with my option");
  EXPECT_EQ(data.figures["also"][0][3], "5.00");
  for (const char* const wrong : {"file", "=file", "name="})
    EXPECT_NE(fault_of([&] { parse_also(wrong); }).find("is not NAME=FILE"), std::string::npos);
  location.files.also = {parse_also("gone=" + (folder_ / "gone.jsonl").string())};
  EXPECT_NE(fault_of([&] { find_run(location); }).find("of 'gone': there is no"),
            std::string::npos);
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
  const std::vector<std::string> checks = {"collision checks, mean", "5 000", "2 000", "2.50",
                                           "0.5000"};
  EXPECT_EQ(data["table"]["rows"][1], checks) << "as in the terminal";
  EXPECT_EQ(data["newcomer"]["frames"][0]["held"][0]["name"], "box");
  EXPECT_EQ(data["guides"], nlohmann::json::parse(R"([{"guide": "ways", "queries": 2}])"));
  EXPECT_EQ(data["searches"]["guided"]["parents"], (std::vector<int>{-1, -1, 0, 2}));
  EXPECT_EQ(data["advice"]["share"], 0.25) << "of now, not of the fetch before the attempts";
  EXPECT_EQ(data["advice"]["evidence"], "guided 1 in 2");
  EXPECT_EQ(data["obstacles"][0]["name"], "</script><b>");
  EXPECT_EQ(data["also"], nlohmann::json::array());
  EXPECT_EQ(data["uniform_time_s"]["mean"], 0.005);
  EXPECT_EQ(data["guided_time_s"]["mean"], 0.002);
}

TEST_F(Page, AllThatIsMissingIsNamedAtOnce) {
  std::filesystem::remove(folder_ / "distribution.json");
  std::filesystem::remove(folder_ / "ur10e.problems.jsonl");
  const std::string fault = fault_of([&] { run(); });
  EXPECT_NE(fault.find("--distribution, or call it distribution.json"), std::string::npos) << fault;
  EXPECT_NE(fault.find("--problems, or call it ROBOT.problems.jsonl"), std::string::npos) << fault;
  EXPECT_EQ(fault.find("--uniform"), std::string::npos) << fault;
}

TEST_F(Page, ARunOfSeveralRobotsAsksWhich) {
  write_results("ur10e", "sawyer-uniform", {1});
  write_results("ur10e", "sawyer-guided", {1});
  EXPECT_NE(fault_of([&] { run(); }).find("say --robot (sawyer, ur10e)"), std::string::npos);
}

TEST_F(Page, FilesMayHaveAnyName) {
  RunLocation location;
  RunFiles& files = location.files;
  files.robot.source = std::filesystem::path(kModels) / "ur10e";
  const auto moved = [&](const std::string& from, const std::string& to) {
    std::filesystem::rename(folder_ / from, folder_ / to);
    return folder_ / to;
  };
  files.problems = moved("ur10e.problems.jsonl", "a");
  files.uniform = moved("ur10e-uniform.results.jsonl", "b");
  files.guided = moved("ur10e-guided.results.jsonl", "c");
  files.distribution = moved("distribution.json", "d");
  files.teachers = {parse_teacher((std::filesystem::path(kModels) / "panda").string() + "," +
                                  (folder_ / "panda.problems.jsonl").string() + "," +
                                  (folder_ / "panda.results.jsonl").string())};
  const PageData data = read_run(find_run(location));
  EXPECT_EQ(data.robot, "ur10e");
  EXPECT_EQ(data.fleet.size(), 1U);
  EXPECT_EQ(data.figures["uniform_checks"]["mean"], 5000);
  EXPECT_THROW(parse_teacher("model,problems"), Failure);
}

TEST_F(Page, APathOfAnotherRobotIsRefused) {
  write_results("ur10e", "panda", {1, 1});
  EXPECT_NE(fault_of([&] { read_run(run()); }).find("has 6 joints, panda 7"), std::string::npos);
}

TEST_F(Page, AnAnswerToNoProblemIsRefused) {
  write_problems("ur10e", 0);
  std::ofstream(folder_ / "ur10e.problems.jsonl") << json::to_json(problem("ur10e", 7)) << '\n';
  EXPECT_NE(fault_of([&] { read_run(run()); }).find("answers 'p0', which is none of the 1"),
            std::string::npos);
}

}  // namespace
}  // namespace kinship::experiments::page_test
