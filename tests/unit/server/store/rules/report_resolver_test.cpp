#include "server/store/rules/report_resolver.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "tests/support/store_values.hpp"

namespace kinship::store::report_resolver_test {
namespace {

constexpr std::int64_t kNow = 1'000'000;

/// A batch of one robot and task, and what a store has of it.
class ReportResolverTest : public testing::Test {
 protected:
  ReportResolverTest() {
    state_.robots[robot_.digest] = {.id = 1, .dof = test::kDof};
    state_.pairs[{robot_.digest, "shelf"}].key = {.task_id = 2, .robot_id = 1};
    for (std::int64_t id = 100; id < 200; ++id)
      state_.path_ids.push_back(id);
  }
  const PreparedAttempt& add(std::uint64_t number, std::uint64_t path) {
    Attempt attempt = test::make_attempt(robot_.digest, "shelf", number);
    attempt.path = test::make_path(path);
    prepared_.push_back(prepare(std::move(attempt)).value_or_throw());
    batch_.push_back(&prepared_.back());
    return prepared_.back();
  }
  BatchChanges resolve(std::uint64_t max_paths = 0) {
    return resolve_reports(batch_, state_, max_paths, kNow);
  }
  Pair& pair() { return state_.pairs.begin()->second; }
  EarlierReport came_before(const PreparedAttempt& prepared) const {
    return {.body = prepared.body, .machine = prepared.attempt.machine, .received_ms = 5};
  }

  const RobotRecord robot_ = test::make_robot("panda", 1);
  std::deque<PreparedAttempt> prepared_;
  std::vector<const PreparedAttempt*> batch_;
  BatchState state_;
};

TEST_F(ReportResolverTest, AResendWritesThatItCameAndNothingElse) {
  const PreparedAttempt& again = add(1, 1);
  state_.reports[again.attempt.report_uuid] = came_before(again);
  const BatchChanges made = resolve();
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Duplicate);
  EXPECT_FALSE(made.is_empty()) << "its answer has to wait for the standby";
  EXPECT_TRUE(made.paths.empty() && made.attempts.empty() && made.pairs.empty());
}

TEST_F(ReportResolverTest, AStoredPathGoesForASmallerOne) {
  const PreparedAttempt& only = add(1, 1);
  Digest largest = only.path->content;
  largest.bytes.fill(0xFF);
  pair().paths = 1;
  pair().largest.insert({largest, 7, 99});
  const BatchChanges made = resolve(1);
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Stored);
  ASSERT_EQ(made.dropped.size(), 1U);
  EXPECT_EQ(made.dropped[0].id, 7);
  EXPECT_EQ(made.dropped[0].crc_when_dropped, 99U);
}

TEST_F(ReportResolverTest, ADamagedPathIsReplacedByTheReportThatBringsItsContent) {
  const PreparedAttempt& again = add(1, 1);
  pair().paths = 1;
  pair().contents[again.path->content] = {.readable = {}, .damaged = {7}, .quarantined = {}};
  EarlierReport earlier = came_before(again);
  earlier.path_id = 7;
  earlier.is_path_backed = false;
  state_.reports[again.attempt.report_uuid] = earlier;
  const BatchChanges made = resolve();
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Stored);
  ASSERT_EQ(made.damaged.size(), 1U);
  EXPECT_EQ(made.damaged[0].id, 7);
  ASSERT_EQ(made.paths.size(), 1U);
  EXPECT_EQ(made.damaged[0].replaced_by, made.paths[0].id);
  EXPECT_EQ(made.paths[0].received_ms, 5) << "when it came first";
  ASSERT_EQ(made.restored.size(), 1U);
  const PairChange& change = made.pairs.at({.task_id = 2, .robot_id = 1});
  EXPECT_EQ(change.paths, 0) << "one out, one in";
  EXPECT_EQ(change.attempts, 0);
  EXPECT_TRUE(change.is_changed);
}

TEST_F(ReportResolverTest, AllDamagedPathsOfAContentAreReplacedAndCountedOnce) {
  const PreparedAttempt& only = add(1, 1);
  pair().paths = 1;
  pair().contents[only.path->content] = {.readable = {}, .damaged = {7}, .quarantined = {5}};
  const BatchChanges made = resolve();
  ASSERT_EQ(made.damaged.size(), 2U);
  for (const DamagedPath& path : made.damaged)
    EXPECT_EQ(path.replaced_by, made.paths.at(0).id);
  EXPECT_EQ(made.pairs.at(pair().key).paths, 0) << "5 was out of the count before";
}

TEST_F(ReportResolverTest, ADamagedPathBeyondTheCapIsNotReplaced) {
  const PreparedAttempt& again = add(1, 1);
  Digest smallest;  // all zero
  pair().paths = 1;
  pair().largest.insert({smallest, 8, 0});
  pair().contents[again.path->content] = {.readable = {}, .damaged = {}, .quarantined = {7}};
  EarlierReport earlier = came_before(again);
  earlier.path_id = 7;
  earlier.is_path_backed = false;
  state_.reports[again.attempt.report_uuid] = earlier;
  const BatchChanges made = resolve(1);
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Recorded);
  EXPECT_FALSE(made.receipts[0].message.empty());
  ASSERT_EQ(made.damaged.size(), 1U);
  EXPECT_EQ(made.damaged[0].replaced_by, std::nullopt);
  ASSERT_EQ(made.restored.size(), 1U);
  EXPECT_EQ(made.restored[0].path_id, std::nullopt);
  EXPECT_EQ(made.pairs.at(pair().key).dropped, 1);
  EXPECT_EQ(made.pairs.at(pair().key).paths, 0);
}

TEST_F(ReportResolverTest, AReportWhoseRowIsDamagedIsWrittenAnewAndCountedOnce) {
  const PreparedAttempt& only = add(1, 1);
  state_.unreadable.insert(only.attempt.report_uuid);
  pair().contents[only.path->content] = {.readable = 7, .damaged = {}, .quarantined = {}};
  const BatchChanges made = resolve();
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Stored);
  ASSERT_EQ(made.attempts.size(), 1U);
  EXPECT_EQ(made.attempts[0].path_id, 7);
  EXPECT_TRUE(made.pairs.empty());
}

TEST_F(ReportResolverTest, ARetiredPathOfAReportThatLostItsRowStaysRetired) {
  const PreparedAttempt& only = add(1, 1);
  state_.retired_paths[only.attempt.report_uuid] = 7;
  const BatchChanges made = resolve();
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Duplicate);
  EXPECT_TRUE(made.paths.empty());
  EXPECT_EQ(made.attempts.at(0).path_id, 7);
  EXPECT_EQ(made.pairs.at(pair().key).attempts, 1);
}

TEST_F(ReportResolverTest, UnderALoweredCapAReportDropsNoMoreThanMayBeDroppedAtOnce) {
  const PreparedAttempt& only = add(1, 1);
  Digest content = only.path->content;
  for (std::uint64_t i = 0; i <= kMaxDroppedAtOnce; ++i) {
    content.bytes.fill(0xFF);
    content.bytes.back() = static_cast<std::uint8_t>(i);
    pair().largest.insert({content, static_cast<std::int64_t>(1000 + i), 0});
  }
  pair().paths = 500;
  const BatchChanges made = resolve(100);
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Stored);
  EXPECT_EQ(made.dropped.size(), kMaxDroppedAtOnce);
  EXPECT_EQ(made.pairs.at(pair().key).dropped, 64);
  EXPECT_EQ(made.pairs.at(pair().key).paths, 1 - 64);
}

}  // namespace
}  // namespace kinship::store::report_resolver_test
