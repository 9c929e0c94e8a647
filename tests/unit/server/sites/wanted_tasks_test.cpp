#include "server/sites/wanted_tasks.hpp"

#include <gtest/gtest.h>

namespace kinship::sites {
namespace {

TEST(WantedTasks, AStarIsAnythingAQuestionMarkOne) {
  EXPECT_TRUE(matches("*", "shelf"));
  EXPECT_TRUE(matches("shelf", "shelf"));
  EXPECT_FALSE(matches("shelf", "shelf_2"));
  EXPECT_TRUE(matches("shelf*", "shelf_2"));
  EXPECT_TRUE(matches("*/pick", "hall 3/pick"));
  EXPECT_FALSE(matches("bin_?", "bin_10"));
  EXPECT_TRUE(matches_any({"a", "b*"}, "bin"));
  EXPECT_FALSE(matches_any({}, "bin"));
}

}  // namespace
}  // namespace kinship::sites
