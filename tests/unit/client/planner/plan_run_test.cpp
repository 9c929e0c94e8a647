#include "client/planner/plan_run.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "proto/json/problem_json.hpp"
#include "proto/security/security_folder.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

namespace kinship::planner::plan_run_test {
namespace {

bool never() { return false; }

/// A folder of this test's own, and the planar arm's URDF in it.
class PlanRun : public testing::Test {
 public:
  ~PlanRun() override { std::filesystem::remove_all(folder_); }

 protected:
  PlanRun() {
    std::filesystem::create_directories(folder_);
    const RobotDescription description = guided::test::planar_description();
    std::ofstream(folder_ / "planar.urdf") << description.urdf;
    options_.robot.source = folder_ / "planar.urdf";
    options_.robot.label = "planar";
    options_.robot.base_link = description.base_link;
    options_.robot.tip_link = description.tip_link;
    options_.guidance = GuidanceMode::Uniform;
  }

  static std::string line(const std::string& name) {
    Problem problem = guided::test::wall_problem();
    problem.name = name;
    return json::to_json(problem) + "\n";
  }

  int run(const std::string& problems, const std::function<bool()>& stop = never) {
    std::istringstream input(problems);
    std::ostringstream output;
    summary_ = run_plan(options_, {input, output, messages_, searches_}, stop);
    const int code = summary_.exit_code;
    std::istringstream lines(output.str());
    for (std::string text; std::getline(lines, text);)
      results_.push_back(json::problem_result_from_json(text).value_or_throw());
    return code;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      ("kinship_plan_run_" + std::to_string(getpid()) + "_" +
       testing::UnitTest::GetInstance()->current_test_info()->name());
  PlanOptions options_;
  std::ostringstream messages_;
  std::ostream* searches_ = nullptr;
  RunSummary summary_;
  std::vector<ProblemResult> results_;
};

TEST_F(PlanRun, SaysWhichGoalIsMovedOntoALimitAndWhichLinksAnSrdfNamesInVain) {
  options_.robot.srdf = folder_ / "planar.srdf";
  std::ofstream(options_.robot.srdf)
      << "<robot name='planar'><disable_collisions link1='camera' link2='lens'/></robot>";
  Problem problem = guided::test::wall_problem();
  problem.name = "near";
  problem.goal_configurations(3, 0) = 2.80005;
  EXPECT_EQ(run(json::to_json(problem) + "\n"), kDone);
  const std::string said = messages_.str();
  for (const std::string what :
       {"warning: problem 'near': goal 1: joint 'j4' at 2.80005 is moved onto its limit 2.8\n",
        "planar.srdf: the robot has no link 'camera' (line 1): a pair that names it is left out\n",
        "planar.srdf: the robot has no link 'lens' (line 1): a pair that names it is left out\n"})
    EXPECT_NE(said.find(what), std::string::npos) << said;
}

TEST_F(PlanRun, AnswersEveryLineInOrderAlsoABrokenOne) {
  EXPECT_EQ(run(line("first") + "{broken\n" + line("third")), kDone);
  ASSERT_EQ(results_.size(), 3U);
  EXPECT_EQ(results_[0].name, "first");
  EXPECT_TRUE(results_[0].solved);
  EXPECT_TRUE(results_[0].path_length && results_[0].hand_length_m);
  EXPECT_GT(results_[0].least_clearance_m, 0);
  EXPECT_FALSE(results_[1].solved);
  EXPECT_NE(results_[1].reason.find("line 2"), std::string::npos);
  EXPECT_EQ(results_[2].name, "third");
}

TEST_F(PlanRun, EachSearchIsWrittenDownWhereItIsAskedForAndChangesNoResult) {
  const std::string problems = line("first") + "{broken\n" + line("third");
  run(problems);
  const std::vector<ProblemResult> without = std::exchange(results_, {});
  std::ostringstream searches;
  searches_ = &searches;
  run(problems);
  ASSERT_EQ(results_.size(), without.size());
  std::istringstream lines(searches.str());
  for (std::size_t i = 0; i < results_.size(); ++i) {
    std::string text;
    ASSERT_TRUE(std::getline(lines, text)) << i;
    const RecordedSearch search = json::recorded_search_from_json(text).value_or_throw();
    EXPECT_EQ(search.name, results_[i].name);
    EXPECT_EQ(results_[i].waypoints, without[i].waypoints);
    EXPECT_EQ(results_[i].collision_checks, without[i].collision_checks);
    EXPECT_EQ(search.path.empty(), !results_[i].solved);
    if (results_[i].solved) {
      EXPECT_LE(search.checks.back(), results_[i].collision_checks);
    }
  }
}

TEST_F(PlanRun, CredentialsThatEndSoonAreToldOnce) {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto fleet = security::SecurityFolder::init(folder_ / "fleet", security::kDefaultDays, now);
  const kinship::test::ReservedDomain domain;
  options_.domain = domain.number();
  options_.guidance = GuidanceMode::Auto;
  options_.task = "reach";
  options_.timeout = std::chrono::milliseconds(10);
  const auto told = [&](const std::string& name, std::chrono::days days) {
    options_.security = folder_ / name;
    fleet.add({.name = name, .days = days}, options_.security, now);
    messages_.str("");
    EXPECT_EQ(run(line("first")), kDone) << messages_.str();
    return messages_.str();
  };
  const std::string soon = told("r1", std::chrono::days(20));
  const std::string warning = "warning: the credentials of 'r1' expire in ";
  EXPECT_NE(soon.find(warning), std::string::npos) << soon;
  EXPECT_EQ(soon.find(warning), soon.rfind(warning));
  EXPECT_NE(soon.find("kinshipd secure renew r1"), std::string::npos) << soon;
  EXPECT_EQ(told("r2", std::chrono::days(40)).find("expire"), std::string::npos);
}

TEST_F(PlanRun, UnsolvedIsAnAnswer) {
  options_.settings.max_checks = 5;
  EXPECT_EQ(run(line("hard")), kDone);
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_FALSE(results_[0].solved);
}

TEST_F(PlanRun, FailsIfNoLineCouldBeAttempted) {
  Problem other_robots = guided::test::wall_problem();
  other_robots.start = Eigen::VectorXd::Zero(6);
  other_robots.goal_configurations = Eigen::MatrixXd::Zero(6, 1);
  const std::string misfit = json::to_json(other_robots) + "\n";
  EXPECT_EQ(run("{broken\n" + misfit), kFailed);
  EXPECT_TRUE(summary_.is_complete);
  ASSERT_EQ(results_.size(), 2U);
  EXPECT_NE(results_[1].reason.find("the robot 4: 'j1', 'j2', 'j3', 'j4'"), std::string::npos)
      << results_[1].reason;
  EXPECT_EQ(run(misfit + line("fits")), kDone);
}

TEST_F(PlanRun, EachResultSaysItsPlannerAndWhyItWasNotGuided) {
  run(line("a"));
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_EQ(results_[0].planner, "BiRRT");
  EXPECT_EQ(results_[0].guidance_reason, "no task is named");
}

TEST_F(PlanRun, PeopleGetALineOfTextForEachProblem) {
  std::istringstream input(line("a") + "{broken\n");
  std::ostringstream output;
  run_plan(
      options_,
      {.problems = input, .results = output, .messages = messages_, .results_for_people = true},
      never);
  EXPECT_NE(output.str().find("a: solved, "), std::string::npos) << output.str();
  EXPECT_NE(output.str().find("; uniform: no task is named\nline 2: "), std::string::npos)
      << output.str();
}

TEST_F(PlanRun, TheSeedOffsetGivesAnotherRunOfTheSameProblem) {
  run(line("a") + line("a"));
  options_.seed_offset = 1;
  run(line("a"));
  ASSERT_EQ(results_.size(), 3U);
  EXPECT_EQ(results_[0].collision_checks, results_[1].collision_checks);
  EXPECT_NE(results_[0].collision_checks, results_[2].collision_checks);
}

TEST_F(PlanRun, AnInterruptKeepsWhatIsPlanned) {
  int asked = 0;
  int first = 0;
  run(line("count"), [&] { return ++asked < 0; });
  first = asked;
  results_.clear();
  asked = 0;
  EXPECT_EQ(run(line("a") + line("b"), [&] { return ++asked > first + 10; }), kFailed);
  ASSERT_EQ(results_.size(), 1U);
  EXPECT_EQ(results_[0].name, "a");
  EXPECT_NE(messages_.str().find("interrupted"), std::string::npos);
}

TEST_F(PlanRun, AMissingRobotIsNamed) {
  options_.robot.source = folder_ / "nobody.urdf";
  try {
    run(line("a"));
    FAIL() << "planned without a robot";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
    EXPECT_NE(std::string(failure.what()).find("nobody.urdf"), std::string::npos);
  }
}

/// Text that is looked at whenever it is flushed.
class WatchedText : public std::stringbuf {
 public:
  explicit WatchedText(std::function<void()> look) : look_(std::move(look)) {}

 private:
  int sync() override {
    look_();
    return 0;
  }
  std::function<void()> look_;
};

/// With a client, on a domain where nobody answers.
class PlanRunWithoutServer : public PlanRun {
 protected:
  PlanRunWithoutServer() {
    options_.task = "wall";
    options_.domain = domain_.number();
    options_.timeout = std::chrono::milliseconds(200);
    options_.outbox = folder_ / "outbox";
    options_.guidance = GuidanceMode::Uniform;
  }

 private:
  kinship::test::ReservedDomain domain_;
};

TEST_F(PlanRunWithoutServer, RequiredGuidanceEndsTheRunBeforePlanning) {
  options_.guidance = GuidanceMode::Require;
  EXPECT_EQ(run(line("a")), kNoServer);
  EXPECT_TRUE(results_.empty());
}

TEST_F(PlanRunWithoutServer, AnInterruptEndsTheWaitForAServer) {
  options_.guidance = GuidanceMode::Require;
  options_.timeout = std::chrono::hours(1);
  int asked = 0;
  EXPECT_EQ(run(line("a"), [&] { return ++asked > 2; }), kFailed);
  EXPECT_TRUE(results_.empty());
  EXPECT_NE(messages_.str().find("interrupted"), std::string::npos) << messages_.str();
}

TEST_F(PlanRunWithoutServer, WantedGuidanceIsDoneWithoutAndReportsWait) {
  options_.guidance = GuidanceMode::Auto;
  options_.report = true;
  EXPECT_EQ(run(line("a") + line("b")), kDone);
  ASSERT_EQ(results_.size(), 2U);
  EXPECT_TRUE(results_[1].solved);
  EXPECT_FALSE(results_[1].distribution_id);
  EXPECT_NE(messages_.str().find("no guidance, all is planned uniformly: "), std::string::npos);
  EXPECT_NE(results_[1].guidance_reason, "");
  EXPECT_NE(messages_.str().find("2 pending"), std::string::npos) << messages_.str();
}

TEST_F(PlanRunWithoutServer, AnOutboxThatCannotBeMadeDoesNotStopPlanning) {
  std::ofstream(folder_ / "file") << "not a folder";
  options_.outbox = folder_ / "file" / "outbox";
  options_.guidance = GuidanceMode::Auto;
  options_.report = true;
  EXPECT_EQ(run(line("a") + line("b")), kFailed);
  EXPECT_TRUE(summary_.is_complete);
  ASSERT_EQ(results_.size(), 2U);
  EXPECT_TRUE(results_[1].solved);
  EXPECT_NE(messages_.str().find("no guidance, "), std::string::npos) << messages_.str();
  EXPECT_NE(messages_.str().find("2 attempts could not be kept"), std::string::npos)
      << messages_.str();
}

TEST_F(PlanRunWithoutServer, AnOutboxThatCannotBeMadeFailsRequiredGuidance) {
  std::ofstream(folder_ / "file") << "not a folder";
  options_.outbox = folder_ / "file" / "outbox";
  options_.guidance = GuidanceMode::Require;
  options_.report = true;
  EXPECT_EQ(run(line("a")), kFailed);
  EXPECT_TRUE(results_.empty());
}

TEST_F(PlanRunWithoutServer, ReportIsInTheOutboxBeforeItsResultIsWritten) {
  options_.guidance = GuidanceMode::Uniform;
  options_.report = true;
  std::vector<std::ptrdiff_t> reports;  // in the outbox, at each result
  WatchedText text([&] {
    reports.push_back(
        std::distance(std::filesystem::directory_iterator(options_.outbox / "pending"), {}));
  });
  std::istringstream input(line("a") + line("b"));
  std::ostream output(&text);
  EXPECT_EQ(run_plan(options_, {input, output, messages_}, never).exit_code, kDone);
  EXPECT_EQ(reports, (std::vector<std::ptrdiff_t>{1, 2}));
}

TEST_F(PlanRunWithoutServer, WithoutReportingNoOutboxIsOpened) {
  options_.guidance = GuidanceMode::Auto;
  EXPECT_EQ(run(line("a")), kDone);
  EXPECT_FALSE(std::filesystem::exists(options_.outbox));
}

TEST_F(PlanRun, AnObstacleOutOfReachIsWarnedOfOnce) {
  Problem problem = guided::test::wall_problem();
  SceneObject far{"moon", SphereShape{1}};
  far.T_task_object.translation().x() = 500;
  problem.scene.objects.push_back(far);
  const std::string text = json::to_json(problem) + "\n";
  run(text + text);
  const std::string said = messages_.str();
  const std::size_t first = said.find("'moon' is 499 m away");
  ASSERT_NE(first, std::string::npos) << said;
  EXPECT_EQ(said.find("'moon'", first + 1), std::string::npos) << said;
}

TEST_F(PlanRun, ARobotThatIsOnlyDrawnIsRefusedUnlessToldOtherwise) {
  std::string urdf = guided::test::planar_description().urdf;
  for (std::size_t at = 0; (at = urdf.find("collision>", at)) != std::string::npos;)
    urdf.replace(at, 10, "visual>");
  std::ofstream(options_.robot.source) << urdf;
  EXPECT_THROW(run(line("first")), Failure);
  options_.robot.collision_from_visual = true;
  EXPECT_EQ(run(line("first")), kDone);
  EXPECT_TRUE(results_.at(0).solved);
}

}  // namespace
}  // namespace kinship::planner::plan_run_test
