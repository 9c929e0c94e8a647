#include "server/quotas/known_tasks.hpp"

#include <gtest/gtest.h>

namespace kinship::quotas::known_tasks_test {
namespace {

TEST(KnownTasks, TellsWhatIsNewAndIsBounded) {
  KnownTasks tasks(2);
  EXPECT_TRUE(tasks.add("shelf"));
  EXPECT_FALSE(tasks.add("shelf"));
  EXPECT_TRUE(tasks.add("bin"));
  EXPECT_TRUE(tasks.has("shelf") && tasks.has("bin"));
  EXPECT_TRUE(tasks.add("table"));
  EXPECT_TRUE(tasks.has("table"));
  EXPECT_FALSE(tasks.has("shelf")) << "the store is asked again";
}

}  // namespace
}  // namespace kinship::quotas::known_tasks_test
