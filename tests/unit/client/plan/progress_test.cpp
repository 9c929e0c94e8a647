#include "client/plan/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

namespace kinship::plan {
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
    progress.add(solved("p", 100));
  const std::string text = stream.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_NE(text.find("planned 2/20, solved 2, last: p 100 checks\n"), std::string::npos);
}

TEST(Progress, WritesOverOneLineOnATerminal) {
  std::ostringstream stream;
  Progress progress(stream, true, 20);
  for (int i = 0; i < 20; ++i)
    progress.add(solved("p", 100));
  const std::string text = stream.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 0);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 20);
}

TEST(Progress, EndsWithTheSums) {
  std::ostringstream stream;
  Progress progress(stream, false, 3);
  progress.add(solved("a", 100));
  progress.add(solved("b", 300));
  progress.finish();
  EXPECT_NE(stream.str().find("planned 2 of 3 problems, solved 2; on average 200 checks"),
            std::string::npos);
}

TEST(Progress, NoProblemsIsNoDivisionByZero) {
  std::ostringstream stream;
  Progress(stream, false, 0).finish();
  EXPECT_EQ(stream.str(), "planned 0 of 0 problems, solved 0\n");
}

}  // namespace
}  // namespace kinship::plan
