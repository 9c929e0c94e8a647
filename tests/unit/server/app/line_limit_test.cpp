#include "server/app/line_limit.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace kinship::app::line_limit_test {
namespace {

using std::chrono::seconds;

TEST(LineLimit, PassesOnSoManyLinesAWindowAndSaysHowManyItLeftOut) {
  LineLimit::Clock::time_point now{};
  std::vector<std::string> lines;
  LineLimit limit([&](std::string_view line) { lines.emplace_back(line); },
                  {.lines = 2, .window = seconds(10), .now = [&] { return now; }});
  for (const char* line : {"a", "b", "c", "d"})
    limit.write(line);
  EXPECT_EQ(lines, (std::vector<std::string>{"a", "b"}));
  now += seconds(10);
  limit.write("e");
  EXPECT_EQ(lines, (std::vector<std::string>{"a", "b", "2 further lines were left out", "e"}));
  now += seconds(10);
  limit.write("f");
  EXPECT_EQ(lines.back(), "f");
  EXPECT_EQ(lines.size(), 5U);
}

}  // namespace
}  // namespace kinship::app::line_limit_test
