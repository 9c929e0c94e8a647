#include "client/planner/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

namespace kinship::planner::progress_test {
namespace {

ProblemResult solved(const std::string& name, std::uint64_t checks) {
  ProblemResult result;
  result.name = name;
  result.solved = true;
  result.collision_checks = checks;
  return result;
}

TEST(Progress, WritesALineForEveryTenthWhereNobodyCanWriteOver) {
  std::ostringstream stream;
  Progress progress(stream, false, 20);
  for (int i = 0; i < 20; ++i)
    progress.add(solved("p", 100), true);
  const std::string text = stream.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_NE(text.find("planned 2/20, solved 2, last: p: 100 checks\n"), std::string::npos);
}

TEST(Progress, NamesALineThatCouldNotBeReadOnce) {
  std::ostringstream stream;
  Progress progress(stream, false, 1);
  ProblemResult unreadable;
  unreadable.name = "line 3";
  unreadable.reason = "line 3: problem: not JSON at byte 9";
  progress.add(unreadable, false);
  EXPECT_NE(stream.str().find("last: line 3: problem: not JSON at byte 9\n"), std::string::npos)
      << stream.str();
}

TEST(Progress, WritesOverOneLineOnATerminal) {
  std::ostringstream stream;
  Progress progress(stream, true, 20);
  for (int i = 0; i < 20; ++i)
    progress.add(solved("p", 100), true);
  const std::string text = stream.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 0);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 20);
}

TEST(Progress, EndsWithTheSums) {
  std::ostringstream stream;
  Progress progress(stream, false, 3);
  progress.add(solved("a", 100), true);
  progress.add(solved("b", 300), true);
  progress.finish();
  EXPECT_NE(stream.str().find("planned 2 of 3 problems, 2 solved; 0 guided, 0 control, 2 uniform; "
                              "on average 200 checks"),
            std::string::npos);
}

TEST(Progress, TellsWhatThePathsOfEachModeMeasure) {
  std::ostringstream stream;
  Progress progress(stream, false, 5);
  ProblemResult result = solved("a", 100);
  const auto add = [&](double length, double hand_m, double clearance_m) {
    result.path_length = length;
    result.hand_length_m = hand_m;
    result.least_clearance_m = clearance_m;
    progress.add(result, true);
  };
  add(4, 1, 0.002);
  result.sampling_mode = SamplingMode::Guided;
  add(1, 0.5, 0.004);
  add(2, 0.75, 0.01);
  add(6, 2.5, 0.1);
  progress.add(ProblemResult(), true);
  progress.finish();
  EXPECT_TRUE(stream.str().ends_with(
      "\npaths guided: length 3.00, median 2.00; hand's 1.25 m, median 0.75 m; least clearance "
      "38.0 mm, median 10.0 mm\n"
      "paths uniform: length 4.00, median 4.00; hand's 1.00 m, median 1.00 m; least clearance "
      "2.0 mm, median 2.0 mm\n"))
      << stream.str();
}

TEST(Progress, TellsHowManyTheGatePlannedUniformly) {
  std::ostringstream stream;
  Progress progress(stream, false, 2);
  ProblemResult guided = solved("a", 100);
  guided.sampling_mode = SamplingMode::Guided;
  progress.add(guided, true);
  guided.gate_fired = true;
  progress.add(guided, true);
  progress.finish();
  EXPECT_NE(stream.str().find("2 guided (1 uniform by the gate), 0 control"), std::string::npos)
      << stream.str();
}

ProblemResult not_planned(const std::string& name, NotPlanned why, const std::string& reason) {
  ProblemResult result;
  result.name = name;
  result.not_planned = why;
  result.reason = reason;
  return result;
}

TEST(Progress, CountsSearchesByArmAndNothingElse) {
  std::ostringstream stream;
  Progress progress(stream, false, 4);
  ProblemResult guided = solved("a", 100);
  guided.sampling_mode = SamplingMode::Guided;
  ProblemResult control = solved("b", 500);
  control.sampling_mode = SamplingMode::Control;
  progress.add(guided, true);
  progress.add(control, true);
  progress.add(ProblemResult{}, true);
  progress.add(not_planned("d", NotPlanned::DofMismatch, "start has 6 joints"), false);
  progress.finish();
  EXPECT_NE(stream.str().find("planned 3 of 4 problems, 2 solved; 1 guided, 1 control, 1 uniform; "
                              "on average 200 checks and 0 s; 1 could not be planned (dof "
                              "mismatch: 1):\n"),
            std::string::npos)
      << stream.str();
}

TEST(Progress, LeavesOutOfAveragesWhatNoSearchWasBegunFor) {
  std::ostringstream stream;
  Progress progress(stream, false, 2);
  ProblemResult planned = solved("a", 100);
  planned.planning_time_s = 0.0024;
  progress.add(planned, true);
  // Its own check of the start is no search, whatever arm it was meant for.
  ProblemResult collides = not_planned("b", NotPlanned::StartCollides, "start collides");
  collides.collision_checks = 1;
  collides.sampling_mode = SamplingMode::Guided;
  progress.add(collides, true);
  progress.finish();
  EXPECT_NE(stream.str().find("planned 1 of 2 problems, 1 solved; 0 guided, 0 control, 1 uniform; "
                              "on average 100 checks and 2.40 ms; 1 could not be planned"),
            std::string::npos)
      << stream.str();
  EXPECT_FALSE(progress.nothing_attempted());
}

TEST(Progress, GroupsWhyAndNamesTheFirstThree) {
  std::ostringstream stream;
  Progress progress(stream, true, 5);
  progress.add(not_planned("far", NotPlanned::GoalOutOfReach, "goal out of reach"), true);
  for (const std::string name : {"b", "c", "d"})
    progress.add(not_planned(name, NotPlanned::StartCollides, "start collides: 'x'"), true);
  progress.add(solved("e", 100), true);
  progress.finish();
  const std::string text = stream.str();
  EXPECT_EQ(text.substr(text.rfind("\033[K") + 3),
            "planned 1 of 5 problems, 1 solved; 0 guided, 0 control, 1 uniform; on average 100 "
            "checks and 0 s; 4 could not be planned (start collides: 3, goal out of reach: 1):\n"
            "  far: goal out of reach\n"
            "  b: start collides: 'x'\n"
            "  c: start collides: 'x'\n"
            "  and 1 more\n");
}

TEST(Progress, NoProblemsIsNoDivisionByZero) {
  std::ostringstream stream;
  Progress(stream, false, 0).finish();
  EXPECT_EQ(stream.str(), "planned 0 of 0 problems, 0 solved\n");
}

}  // namespace
}  // namespace kinship::planner::progress_test
