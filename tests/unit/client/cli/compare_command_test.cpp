#include "client/cli/compare_command.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace kinship::cli::compare_command_test {
namespace {

Rehearsal rehearsal(double uniform, double guided) {
  return {
      .guide = Guide::Ways,
      .is_complete = true,
      .queries = 50,
      .costs = {{Guide::None, 50, 50, uniform, uniform}, {Guide::Ways, 50, 50, guided, guided}}};
}

Transferability pair(std::uint8_t target, std::uint8_t source, std::optional<Rehearsal> rehearsal) {
  const auto label = [](std::uint8_t robot) { return "arm" + std::to_string(robot); };
  return {Digest{{target}}, Digest{{source}},     label(target),
          label(source),    std::move(rehearsal), ""};
}

TEST(Worth, IsUniformToTheGuideThatIsTaken) {
  EXPECT_DOUBLE_EQ(worth(rehearsal(900, 300)).value(), 3);
}

TEST(Worth, IsUnknownWhereNothingWasPlanned) {
  EXPECT_FALSE(worth(Rehearsal{}));
  EXPECT_FALSE(worth({.guide = Guide::Ways, .costs = {{Guide::Ways, 50, 50, 300, 300}}}));
  EXPECT_FALSE(worth(rehearsal(900, 0)));
}

TEST(PrintWorths, IsAMatrixWithTheBestSourceOfEachTarget) {
  std::ostringstream out;
  print_worths({pair(1, 1, rehearsal(900, 300)), pair(1, 2, rehearsal(900, 450)),
                pair(2, 1, rehearsal(100, 80)), pair(2, 2, {})},
               out);
  EXPECT_EQ(out.str(),
            "TARGET \\ SOURCE  arm1   arm2\n"
            "arm1             3.00*  2.00\n"
            "arm2             1.25*  -\n");
}

}  // namespace
}  // namespace kinship::cli::compare_command_test
