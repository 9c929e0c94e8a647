#include "proto/types/nearest_name.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace kinship::nearest_name_test {
namespace {

TEST(EditDistance, CountsLettersPutInTakenOutChangedOrSwapped) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("lsit", "list"), 1U);
  EXPECT_EQ(edit_distance("ab", "bca"), 3U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("list", "list"), 0U);
}

TEST(Suggestion, IsTheNearestName) {
  const std::vector<std::string> names = {"register", "list", "show", "check"};
  EXPECT_EQ(suggestion("regsiter", names), " (did you mean 'register'?)");
  EXPECT_EQ(suggestion("lsit", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("lost", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("last", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("lo", names), "");
  EXPECT_EQ(suggestion("lists", names), " (did you mean 'list'?)");
  EXPECT_EQ(suggestion("frobnicate", names), "");
  EXPECT_EQ(suggestion("list", {}), "");
}

}  // namespace
}  // namespace kinship::nearest_name_test
