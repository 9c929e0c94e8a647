#include "client/arguments/number_range.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace kinship::arguments::number_range_test {
namespace {

std::string complaint(const CLI::Validator& check, const std::string& given) {
  std::string text = given;
  return check(text);
}

TEST(Between, TakesItsEnds) {
  for (const char* given : {"0.01", "86400", "5", "1e3"})
    EXPECT_EQ(complaint(between(0.01, 86'400.0), given), "") << given;
  EXPECT_EQ(complaint(between<std::uint32_t>(0, 230), "230"), "");
}

TEST(Between, NamesTheValueAndTheRange) {
  EXPECT_EQ(complaint(between<std::uint32_t>(0, 230), "231"),
            "'231' is not a number from 0 to 230");
  EXPECT_EQ(complaint(between(0.0, 2'592'000.0), "1e9"), "'1e9' is not a number from 0 to 2592000");
}

TEST(Between, RefusesWhatIsNoNumber) {
  for (const char* given : {"nan", "-nan", "inf", "-1", "", "five", "5s"})
    EXPECT_NE(complaint(between(0.0, 100.0), given), "") << given;
}

}  // namespace
}  // namespace kinship::arguments::number_range_test
