#include "client/planner/problem_lines.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace kinship::planner::problem_lines_test {
namespace {

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

}  // namespace
}  // namespace kinship::planner::problem_lines_test
