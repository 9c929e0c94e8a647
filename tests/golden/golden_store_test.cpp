#include "tests/golden/golden_store.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship {
namespace {

/// A copy of tests/golden/store-N.db, opened by today's code.
class GoldenStore : public testing::TestWithParam<int> {
 protected:
  GoldenStore() {
    const std::string name = "store-" + std::to_string(GetParam()) + ".db";
    std::filesystem::copy_file(std::filesystem::path(KINSHIP_SOURCE_DIR "/tests/golden") / name,
                               directory_ / "store.db");
    store_ = store::open_sqlite_store(directory_ / "store.db");
  }

  const test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_;
};

TEST_P(GoldenStore, StillHasItsRobots) {
  const std::vector<store::RobotRecord> robots = store_->robots();
  ASSERT_EQ(robots.size(), 2U);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const store::RobotRecord& wanted = test::golden_robots()[i];
    EXPECT_EQ(robots[i].digest, wanted.digest);
    EXPECT_EQ(robots[i].description.label, wanted.description.label);
    EXPECT_EQ(robots[i].description.held_joints, wanted.description.held_joints);
    EXPECT_EQ(robots[i].description.never_colliding, wanted.description.never_colliding);
  }
}

TEST_P(GoldenStore, StillHasEveryAttemptAndPath) {
  for (const Attempt& wanted : test::golden_attempts()) {
    const std::optional<Attempt> found = store_->find_attempt(wanted.report_uuid);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->task, wanted.task);
    EXPECT_EQ(found->robot, wanted.robot);
    EXPECT_EQ(found->record.outcome, wanted.record.outcome);
    EXPECT_EQ(found->T_task_base.has_value(), wanted.T_task_base.has_value());
    ASSERT_EQ(found->path.has_value(), wanted.path.has_value());
    EXPECT_TRUE(!wanted.path || found->path->waypoints() == wanted.path->waypoints());
  }
  EXPECT_EQ(store_->status().attempts, 8U);
  EXPECT_EQ(store_->status().paths, 7U);
  EXPECT_EQ(store_->generation(test::golden_robots()[0].digest, "bin"), 1U);
}

TEST_P(GoldenStore, StillHasItsDistribution) {
  const Distribution wanted = test::golden_distribution();
  const std::optional<Distribution> found = store_->find_distribution(wanted.id);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->revision, 2U);
  EXPECT_EQ(found->mixture->means(), wanted.mixture->means());
  EXPECT_EQ(found->mixture->covariances(), wanted.mixture->covariances());
}

TEST_P(GoldenStore, TakesRetriesAndNewReports) {
  for (const Receipt& receipt : test::report(*store_, test::golden_attempts()))
    EXPECT_EQ(receipt.status, ReceiptStatus::Duplicate) << receipt.message;
  const Attempt fresh = test::make_attempt(test::golden_robots()[0].digest, "bin", 1000);
  EXPECT_EQ(test::report(*store_, {fresh})[0].status, ReceiptStatus::Stored);
}

INSTANTIATE_TEST_SUITE_P(Schema, GoldenStore, testing::Values(1));

}  // namespace
}  // namespace kinship
