#include "client/planner/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "client/guided/planner_choice.hpp"
#include "client/ompl/planner_choice.hpp"
#include "client/planner/problem_lines.hpp"
#include "robots/models/robot_arguments.hpp"
#include "tests/support/places.hpp"

namespace kinship::planner::plan_output_test {
namespace {

ProblemResult solved_result() {
  ProblemResult result;
  result.name = "shelf-1";
  result.solved = true;
  result.collision_checks = 3804;
  result.planning_time_s = 0.4123;
  result.time_limit_s = 10;
  result.waypoints = Eigen::MatrixXd::Zero(7, 12);
  result.planner = "BiRRT";
  return result;
}

TEST(ResultText, TellsWhatASolutionCostAndWhatGuidedIt) {
  ProblemResult result = solved_result();
  result.distribution_id = Digest{};
  result.distribution_revision = 4;
  result.sampling_mode = SamplingMode::Guided;
  result.share = 0.9;
  EXPECT_EQ(result_text(result),
            "shelf-1: solved, 12 waypoints; BiRRT, 3804 checks in 412 ms of 10 s; guided by " +
                Digest{}.short_hex() + " revision 4, share 0.90");
}

TEST(ResultText, TellsWhyItIsNotSolvedAndNotGuided) {
  ProblemResult result = solved_result();
  result.solved = false;
  result.waypoints.reset();
  result.reason = "time used up";
  result.guidance_reason = "no server answered";
  EXPECT_EQ(result_text(result),
            "shelf-1: not solved, time used up; BiRRT, 3804 checks in 412 ms of 10 s; "
            "uniform: no server answered");
}

TEST(ResultText, NamesABrokenLineOnce) {
  ProblemResult result;
  result.name = "line 3";
  result.reason = "line 3: not JSON";
  result.not_planned = NotPlanned::Unreadable;
  EXPECT_EQ(result_text(result), "line 3: not JSON");
  result.name = "misfit";
  result.reason = "start has 6 joints";
  EXPECT_EQ(result_text(result), "misfit: start has 6 joints");
}

constexpr const char* kGood = R"({"name":"a","T_task_base":[0,0,0,0,0,0,1],"start":[0,0],)"
                              R"("goal":{"configurations":[[1,1]]},"seed":4})";

TEST(ProblemLines, ABrokenLineDoesNotHideTheOthers) {
  std::istringstream stream(std::string(kGood) + "\n{\"name\":\n\n" + kGood + "\n");
  const auto lines = read_problem_lines(stream);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_TRUE(lines[0].problem);
  EXPECT_FALSE(lines[1].problem);
  EXPECT_EQ(lines[1].number, 2U);
  EXPECT_TRUE(lines[2].problem);
  EXPECT_EQ(lines[2].number, 4U);  // blank lines count, as in an editor
}

TEST(ProblemLines, TheAnswerToABrokenLineNamesItAndSaysWhy) {
  const ProblemResult result =
      broken_line_result(7, {ErrorCode::InvalidInput, "problem.start: is empty"});
  EXPECT_FALSE(result.solved);
  EXPECT_EQ(result.reason, "line 7: problem.start: is empty");
}

TEST(ProblemLines, WhatCannotBeReadIsNotAnEmptyFile) {
  std::ifstream directory(std::filesystem::temp_directory_path());
  EXPECT_THROW(read_problem_lines(directory), Failure);
}

ProblemLine line_of(Problem problem) { return {1, Result<Problem>(std::move(problem))}; }

Problem of_joints() {
  Problem problem;
  problem.name = "by joints";
  problem.start = Eigen::VectorXd::Zero(2);
  problem.goal_configurations = Eigen::MatrixXd::Ones(2, 1);
  return problem;
}

TEST(TransferWarning, NamesTheFirstProblemWithAPoseAndWhatToPass) {
  Problem posed = of_joints();
  posed.name = "by pose";
  posed.T_task_goal = Eigen::Isometry3d::Identity();
  const std::string warning = transfer_warning({{1, Error{ErrorCode::InvalidInput, "broken"}},
                                                line_of(of_joints()),
                                                line_of(posed),
                                                line_of(posed)},
                                               "tool0");
  EXPECT_EQ(warning.find("warning: the goal of 'by pose' is a pose"), 0U) << warning;
  EXPECT_NE(warning.find("those of the tip link 'tool0'"), std::string::npos) << warning;
  EXPECT_NE(warning.find("--transfer \"x y z qx qy qz qw\""), std::string::npos) << warning;
  EXPECT_EQ(std::count(warning.begin(), warning.end(), '\n'), 1);
  posed.T_task_start = Eigen::Isometry3d::Identity();
  EXPECT_EQ(transfer_warning({line_of(posed)}, "tool0").find("warning: the start of 'by pose'"),
            0U);
}

TEST(TransferWarning, IsSilentWhereOnlyJointsAreGiven) {
  EXPECT_EQ(transfer_warning({line_of(of_joints())}, "tool0"), "");
  EXPECT_EQ(transfer_warning({}, "tool0"), "");
}

TEST(TransferWarning, AFolderOrAnOptionSaysTheTransferFrame) {
  const std::string folder = kinship::test::source_dir() + "/robots/models/panda";
  EXPECT_TRUE(models::says_transfer({.source = folder}));
  EXPECT_FALSE(models::says_transfer({.source = folder + "/robot.urdf"}));
  EXPECT_TRUE(
      models::says_transfer({.source = folder + "/robot.urdf", .transfer = "0 0 0 0 0 0 1"}));
}

}  // namespace
}  // namespace kinship::planner::plan_output_test

namespace kinship::guided::planner_choice_test {
namespace {

PlannerKind kind_for(PlannerKind wanted, bool is_constrained) {
  return planner_for({wanted}, is_constrained).value().kind;
}

TEST(PlannerChoice, ReadsWhatItCanBeTold) {
  EXPECT_EQ(parse_planner("birrt").value().kind, PlannerKind::Birrt);
  EXPECT_EQ(parse_planner("cbirrt2").value().kind, PlannerKind::Cbirrt2);
  EXPECT_EQ(parse_planner("roadmap").value().kind, PlannerKind::Roadmap);
  EXPECT_EQ(parse_planner("rrtconnect").value().kind, PlannerKind::RrtConnect);
  const PlannerChoice ompl = ompl_planners::parse_planner("ompl:LazyPRM").value();
  EXPECT_EQ(ompl.kind, PlannerKind::Other);
  EXPECT_EQ(name_of(ompl), "OMPL LazyPRM");
  for (const char* unknown : {"", "BiRRT", "rrt", "by problem", "ompl:", "ompl"}) {
    EXPECT_FALSE(parse_planner(unknown)) << unknown;
    EXPECT_FALSE(ompl_planners::parse_planner(unknown)) << unknown;
  }
  EXPECT_EQ(ompl_planners::parse_planner("roadmap").value().kind, PlannerKind::Roadmap);
  EXPECT_FALSE(parse_planner("ompl:LazyPRM"));
}

TEST(PlannerChoice, AnUnknownPlannerOfOmplIsAnsweredWithThoseThereAre) {
  const Result<PlannerChoice> planner = ompl_planners::parse_planner("ompl:Nobody");
  ASSERT_FALSE(planner);
  EXPECT_NE(planner.error().message.find("'Nobody'"), std::string::npos);
  EXPECT_NE(planner.error().message.find("RRTConnect"), std::string::npos);
}

TEST(PlannerChoice, TheProblemDecidesUnlessSaid) {
  EXPECT_EQ(kind_for(PlannerKind::ByProblem, false), PlannerKind::Birrt);
  EXPECT_EQ(kind_for(PlannerKind::ByProblem, true), PlannerKind::Cbirrt2);
  EXPECT_EQ(kind_for(PlannerKind::Cbirrt2, false), PlannerKind::Birrt);
  EXPECT_EQ(kind_for(PlannerKind::RrtConnect, false), PlannerKind::RrtConnect);
  EXPECT_EQ(kind_for(PlannerKind::Roadmap, false), PlannerKind::Roadmap);
  EXPECT_EQ(kind_for(PlannerKind::Roadmap, true), PlannerKind::Roadmap);
  EXPECT_EQ(planner_for(ompl_planners::parse_planner("ompl:RRT").value(), true).value().other_name,
            "OMPL RRT");
}

TEST(PlannerChoice, WhatAPlannerCannotDoIsRefusedWithWhatCan) {
  for (const PlannerKind kind : {PlannerKind::Birrt, PlannerKind::RrtConnect}) {
    const Result<PlannerChoice> planner = planner_for({kind}, true);
    ASSERT_FALSE(planner);
    EXPECT_NE(planner.error().message.find("--planner cbirrt2"), std::string::npos);
  }
}

}  // namespace
}  // namespace kinship::guided::planner_choice_test
