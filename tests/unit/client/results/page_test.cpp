// A page of a small run: real models, files as deploy/quickstart leaves them.

#include "client/results/page/run_page.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pages/page/bones.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/models/loaded_robot.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::results::page_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models";

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

  /// As page.py finds it.
  PageRun run() const {
    const auto file = [&](const char* name) { return (folder_ / name).string(); };
    const nlohmann::json files = {{"model", kModels + "/ur10e"},
                                  {"problems", file("ur10e.problems.jsonl")},
                                  {"uniform", file("ur10e-uniform.results.jsonl")},
                                  {"guided", file("ur10e-guided.results.jsonl")},
                                  {"distribution", file("distribution.json")},
                                  {"advice", file("advice.json")},
                                  {"uniform-searches", file("ur10e-uniform.searches.jsonl")},
                                  {"guided-searches", file("ur10e-guided.searches.jsonl")}};
    const nlohmann::json document = {
        {"files", files},
        {"teachers",
         {{kModels + "/panda", file("panda.problems.jsonl"), file("panda.results.jsonl")}}},
        {"shown", "p0"},
        {"figures", {{"typical", {{"problem", "p0"}}}, {"also", nlohmann::json::array()}}}};
    return parse_run(document.dump(), {});
  }

  static std::string written(const PageRun& run) {
    std::ostringstream page;
    write_page(run, page);
    return page.str();
  }

  /// The data that the page carries.
  static nlohmann::json data_of(const PageRun& run) {
    const std::string page = written(run);
    const std::string begin = "id=\"data\">";
    const auto first = page.find(begin) + begin.size();
    return nlohmann::json::parse(page.substr(first, page.find("</script>", first) - first));
  }

  static std::string fault_of(const PageRun& run) {
    try {
      written(run);
    } catch (const Failure& failure) {
      return failure.what();
    }
    return "";
  }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path folder_ = directory_.path();
};

TEST_F(Page, ShowsTheFleetsPathsAndSamples) {
  const auto data = data_of(run());
  ASSERT_EQ(data["fleet"].size(), 1U);
  EXPECT_EQ(data["fleet"][0]["label"], "panda");
  EXPECT_EQ(data["fleet"][0]["problems"], 2);
  ASSERT_EQ(data["fleet"][0]["paths"].size(), 2U);
  EXPECT_GT(data["fleet"][0]["paths"][0]["positions"].size(), 3U * 2) << "resampled";
  EXPECT_EQ(data["fleet"][0]["example"]["checks"], 700) << "the median";
  EXPECT_GT(data["samples"]["hand"]["positions"].size(), 3U * 1000);
}

TEST_F(Page, ARobotAndItsBoxGoFromStartToGoal) {
  const auto shown = data_of(run())["newcomer"];
  const models::LoadedRobot robot = load("ur10e");
  const Problem answered = problem("ur10e", 0);
  ASSERT_GT(shown["frames"].size(), 5U);
  EXPECT_EQ(shown["obstacles"].size(), answered.scene.objects.size());
  const auto is_held_at = [&](const nlohmann::json& frame, const Eigen::VectorXd& q) {
    const PoseArray pose = frame["held"][0]["pose"].get<PoseArray>();
    return from_pose_array(pose).value_or_throw().isApprox(
        page::held_objects(robot, answered.attached, *answered.T_task_base, q)
            .front()
            .T_task_object,
        1e-6);
  };
  EXPECT_TRUE(is_held_at(shown["frames"].front(), answered.start));
  EXPECT_TRUE(is_held_at(shown["frames"].back(), answered.goal_configurations.col(0)));
}

TEST_F(Page, ShowsTheSearchesOfItsProblem) {
  const auto searches = data_of(run())["searches"];
  EXPECT_EQ(searches["guided"]["path"], (std::vector<int>{0, 2, 3, 1}));
  EXPECT_EQ(searches["guided"]["parents"], (std::vector<int>{-1, -1, 0, 2}));
  const Problem answered = problem("ur10e", 0);
  const Eigen::Vector3d hand =
      1000 *
      (*answered.T_task_base * kinematics::T_base_transfer(load("ur10e").chain, answered.start))
          .translation();
  for (Eigen::Index i = 0; i < 3; ++i)
    EXPECT_NEAR(searches["uniform"]["hand"][static_cast<std::size_t>(i)], hand(i), 0.5);
}

TEST_F(Page, GoesWithoutWhatARunNeedNotHave) {
  PageRun run = this->run();
  run.advice.clear();
  run.uniform_searches.clear();
  run.teachers.clear();
  auto data = data_of(run);
  EXPECT_TRUE(data["advice"].is_null() && data["searches"].is_null() && data["fleet"].empty());
  EXPECT_FALSE(data["newcomer"].is_null());
  run.figures["typical"] = nullptr;
  run.shown = "p1";
  data = data_of(run);
  EXPECT_TRUE(data["newcomer"].is_null());
  EXPECT_EQ(data["obstacles"].size(), 1U) << "none was solved by both: a problem is shown";
}

TEST_F(Page, EqualFilesGiveAnEqualPage) { EXPECT_EQ(written(run()), written(run())); }

TEST_F(Page, CarriesItsDataAsOneDocument) {
  const auto data = data_of(run());
  EXPECT_EQ(data["robot"], "ur10e");
  EXPECT_EQ(data["held"], (std::vector<std::string>{"box"}));
  EXPECT_EQ(data["distribution"]["configurations"], 12'345);
  EXPECT_EQ(data["distribution"]["sources"][0]["label"], "panda");
  EXPECT_EQ(data["newcomer"]["frames"][0]["held"][0]["name"], "box");
  EXPECT_EQ(data["advice"]["share"], 0.25) << "of now, not of the fetch before the attempts";
  EXPECT_EQ(data["advice"]["evidence"], "guided 1 in 2");
  EXPECT_EQ(data["obstacles"][0]["name"], "</script><b>");
  EXPECT_EQ(data["also"], nlohmann::json::array()) << "the figures are there too";
}

TEST_F(Page, APathOfAnotherRobotIsRefused) {
  write_results("ur10e", "panda", {1, 1});
  EXPECT_NE(fault_of(run()).find("has 6 joints, panda 7"), std::string::npos);
}

TEST_F(Page, AnAnswerToNoProblemIsRefused) {
  std::ofstream(folder_ / "ur10e.problems.jsonl") << json::to_json(problem("ur10e", 7)) << '\n';
  EXPECT_NE(fault_of(run()).find("answers 'p0', which is none of the 1"), std::string::npos);
}

}  // namespace
}  // namespace kinship::results::page_test
