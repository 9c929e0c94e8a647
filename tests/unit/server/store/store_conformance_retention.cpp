#include <algorithm>

#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

TEST_P(StoreRetention, NoReportLeavesTheLedger) {
  for (const Attempt& attempt : reports())
    test::report(*store_, {attempt});
  for (int opened = 0; opened < 2; ++opened) {
    const std::set<Uuid> in_use = kept();
    EXPECT_EQ(store_->status().attempts, kReports);
    EXPECT_EQ(store_->status().paths, kCap);
    EXPECT_EQ(store_->status().dropped_paths, kReports - kCap);
    for (const Attempt& attempt : reports()) {
      const std::optional<Attempt> found = store_->find_attempt(attempt.report_uuid);
      ASSERT_TRUE(found);
      EXPECT_EQ(found->record.collision_checks, attempt.record.collision_checks);
      EXPECT_EQ(found->path.has_value(), in_use.contains(attempt.report_uuid));
      EXPECT_EQ(report(attempt), ReceiptStatus::Duplicate);
      Attempt other = attempt;
      other.record.collision_checks += 1;
      EXPECT_EQ(report(other), ReceiptStatus::Refused);
    }
    EXPECT_EQ(store_->status().dropped_paths, kReports - kCap);
    EXPECT_EQ(kept(), in_use);
    reopen({.paths_per_pair = kCap});
  }
}

TEST_P(StoreRetention, CountsWhatWasNotKeptPerRobotAndTask) {
  test::report(*store_, reports());
  test::report(*store_, {test::make_attempt(iiwa_.digest, "shelf", 1001),
                         test::make_attempt(panda_.digest, "table", 1002)});
  const std::optional<TaskSummary> shelf = store_->find_task("shelf");
  EXPECT_EQ(shelf->paths, kCap + 1);
  EXPECT_EQ(shelf->dropped, kReports - kCap);
  for (const TaskRobotSummary& robot : shelf->robots) {
    EXPECT_EQ(robot.paths, robot.robot == panda_.digest ? kCap : 1);
    EXPECT_EQ(robot.dropped, robot.robot == panda_.digest ? kReports - kCap : 0);
  }
  EXPECT_EQ(store_->find_task("table")->dropped, 0U);
  for (const ExperienceSummary& robot : store_->experience("shelf"))
    EXPECT_EQ(robot.dropped, robot.robot == panda_.digest ? kReports - kCap : 0);
}

TEST_P(StoreRetention, WhatIsDroppedIsInNoReadingAndRaisesTheGenerationAlone) {
  test::report(*store_, reports());
  const std::set<Uuid> before = kept();
  const std::uint64_t generation = store_->generation(panda_.digest, "shelf");
  report_until(true);  // so another one had to go
  const std::set<Uuid> after = kept();
  ASSERT_EQ(after.size(), kCap);
  ASSERT_NE(after, before);
  EXPECT_GT(store_->generation(panda_.digest, "shelf"), generation);
  EXPECT_EQ(store_->experience("shelf").at(0).retired_generation, 0U);
  std::vector<std::int64_t> ids;
  for (const StoredPath& path :
       store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 1000}))
    ids.push_back(path.id);
  EXPECT_EQ(store_->path_ids(panda_.digest, "shelf"), ids);
  const Page<Attempt> exported = store_->export_attempts({}, "", "", 1000, 1'000'000);
  EXPECT_EQ(exported.rows.size(), kCap);
  for (const Attempt& attempt : exported.rows)
    EXPECT_TRUE(after.contains(attempt.report_uuid));
  std::size_t dropped = 0;
  for (const PathSummary& path : store_->list_paths({}, "", "", 1000).rows) {
    EXPECT_EQ(path.dropped, !after.contains(path.report_uuid));
    EXPECT_EQ(path.retired_ms > 0, path.dropped);
    dropped += path.dropped ? 1 : 0;
  }
  EXPECT_GT(dropped, 0U);
}

TEST_P(StoreRetention, WhatIsDroppedCannotBeRetired) {
  test::report(*store_, reports());
  for (const PathSummary& path : store_->list_paths({}, "", "", 1000).rows)
    if (path.dropped) {
      EXPECT_EQ(store_->retire_path(path.report_uuid)->paths, 0U);
    }
  const Result<Retirement> retired = store_->retire_path(report_until(false).report_uuid);
  ASSERT_FALSE(retired);
  EXPECT_EQ(retired.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(retired.error().message.find("not kept"), std::string::npos);
}

TEST_P(StoreRetention, ALoweredCapTakesHoldAsReportsComeAndARaisedOneKeepsMore) {
  reopen({.paths_per_pair = 200});
  test::report(*store_, reports(200));
  EXPECT_EQ(kept().size(), 200U);
  reopen({.paths_per_pair = kCap});
  number_ = 201;
  for (int i = 0; i < 4; ++i) {
    const std::uint64_t generation = store_->generation(panda_.digest, "shelf");
    const std::size_t before = kept().size();
    report(solved(number_++));
    EXPECT_EQ(store_->generation(panda_.digest, "shelf") > generation, kept().size() < before) << i;
  }
  EXPECT_EQ(kept().size(), kCap);
  const test::TemporaryDirectory elsewhere;
  const std::unique_ptr<Store> other = GetParam().open(elsewhere.path(), {.paths_per_pair = kCap});
  ASSERT_TRUE(other->register_robot(panda_));
  test::report(*other, reports(number_ - 1));
  EXPECT_EQ(kept(*other), kept()) << "as if the cap had always been so";
  reopen({.paths_per_pair = 2 * kCap});
  for (std::uint64_t i = 0; i < kCap; ++i)
    EXPECT_EQ(report(solved(number_++)), ReceiptStatus::Stored);
  EXPECT_EQ(kept().size(), 2 * kCap);
}

TEST_P(StoreRetentionBackup, ABackupHasWhatIsKeptAndKnowsTheOthers) {
  test::report(*store_, reports());
  const test::TemporaryDirectory elsewhere;
  ASSERT_TRUE(store_->backup(elsewhere / "store.db", [](double) { return true; }).value_or_throw());
  const std::unique_ptr<Store> copy = GetParam().open(elsewhere.path(), {.paths_per_pair = kCap});
  EXPECT_EQ(kept(*copy), kept());
  EXPECT_EQ(copy->status().dropped_paths, kReports - kCap);
  for (const Receipt& receipt : test::report(*copy, reports()))
    EXPECT_EQ(receipt.status, ReceiptStatus::Duplicate);
}

TEST_P(StoreRetention, DistributionsThatWereNotUsedForLongestMakeRoomAndRevisionsGrow) {
  constexpr std::uint64_t kFew = 6000, kDistributions = 9;  // each takes between 1 and 2 KB
  reopen({.distribution_bytes = kFew});
  test::begin_task(*store_, panda_.digest, "shelf");
  std::vector<Digest> ids;
  for (std::uint64_t number = 1; number <= kDistributions; ++number) {
    const Distribution distribution = test::make_distribution(panda_.digest, "shelf", number);
    ids.push_back(distribution.id);
    store_->put_distribution(distribution);
    EXPECT_LE(store_->status().distribution_bytes, kFew);
    EXPECT_TRUE(store_->find_distribution(distribution.id)) << "never the newest";
  }
  const std::size_t left = store_->status().distributions;
  EXPECT_GT(left, 1U);
  EXPECT_LT(left, kDistributions);
  EXPECT_EQ(store_->list_distributions({}, "", "", 100).rows.size(), left);
  for (std::size_t i = 0; i < ids.size(); ++i)
    EXPECT_EQ(store_->find_distribution(ids[i]).has_value(), i + left >= ids.size()) << i;
  const Distribution first = test::make_distribution(panda_.digest, "shelf", 1);
  reopen({.distribution_bytes = kFew});
  EXPECT_GE(store_->put_distribution(first), 2U);
  const std::uint64_t revision = store_->put_distribution(first);
  reopen({.distribution_bytes = 1});
  store_->put_distribution(test::make_distribution(panda_.digest, "shelf", 2));
  EXPECT_EQ(store_->status().distributions, 1U) << "one is kept alone";
  EXPECT_GT(store_->put_distribution(first), revision);
}

}  // namespace
}  // namespace kinship::store
