#include "server/store/postgres/rows/batch_plan.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "tests/support/store_values.hpp"

namespace kinship::store::postgres::batch_plan_test {
namespace {

constexpr std::int64_t kNow = 1'000'000;

/// A batch of one robot and task, and what the database knows of it.
class BatchPlanTest : public testing::Test {
 protected:
  BatchPlanTest() {
    known_.robots[robot_.digest] = {.id = 1, .dof = test::kDof};
    known_.pairs[{robot_.digest, "shelf"}].key = {.task_id = 2, .robot_id = 1};
    for (std::int64_t id = 100; id < 200; ++id)
      known_.path_ids.push_back(id);
  }
  const PreparedAttempt& add(std::uint64_t number, std::uint64_t path) {
    Attempt attempt = test::make_attempt(robot_.digest, "shelf", number);
    attempt.path = test::make_path(path);
    prepared_.push_back(prepare(std::move(attempt)).value_or_throw());
    batch_.push_back(&prepared_.back());
    return prepared_.back();
  }
  BatchPlan plan(std::uint64_t max_paths = 0) { return make_plan(batch_, known_, max_paths, kNow); }
  Pair& pair() { return known_.pairs.begin()->second; }
  EarlierReport came_before(const PreparedAttempt& prepared) const {
    return {.body = prepared.body, .machine = prepared.attempt.machine, .received_ms = 5};
  }

  const RobotRecord robot_ = test::make_robot("panda", 1);
  std::deque<PreparedAttempt> prepared_;
  std::vector<const PreparedAttempt*> batch_;
  BatchKnowledge known_;
};

TEST_F(BatchPlanTest, EachAttemptSeesThoseBeforeIt) {
  add(1, 1);
  add(1, 1);  // the same again
  add(2, 1);  // the same content
  add(1, 3);  // another body under a known UUID
  const BatchPlan made = plan();
  EXPECT_EQ(test::statuses(made.receipts),
            (std::vector{ReceiptStatus::Stored, ReceiptStatus::Duplicate, ReceiptStatus::Duplicate,
                         ReceiptStatus::Refused}));
  ASSERT_EQ(made.paths.size(), 1U);
  ASSERT_EQ(made.attempts.size(), 2U);
  EXPECT_EQ(made.attempts[1].status, AttemptStatus::DuplicateContent);
  EXPECT_EQ(made.attempts[1].path_id, made.paths[0].id);
  const PairChange& change = made.changes.at({.task_id = 2, .robot_id = 1});
  EXPECT_EQ(change.paths, 1);
  EXPECT_EQ(change.attempts, 2);
  EXPECT_EQ(made.resent.size(), 1U);
}

TEST_F(BatchPlanTest, AResendWritesThatItCameAndNothingElse) {
  const PreparedAttempt& again = add(1, 1);
  known_.reports[again.attempt.report_uuid] = came_before(again);
  const BatchPlan made = plan();
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Duplicate);
  EXPECT_FALSE(made.writes_nothing()) << "its answer has to wait for the standby";
  EXPECT_TRUE(made.paths.empty() && made.attempts.empty() && made.changes.empty());
}

TEST_F(BatchPlanTest, APathOverTheCapMakesTheOneWithTheLargestDigestGo) {
  for (std::uint64_t i = 1; i <= 6; ++i)
    add(i, i);
  std::set<Digest> smallest;
  for (const PreparedAttempt& each : prepared_)
    smallest.insert(each.path->content);
  smallest.erase(std::next(smallest.begin(), 2), smallest.end());
  const BatchPlan made = plan(2);
  std::set<Digest> kept;
  for (const PlannedPath& path : made.paths)
    if (!path.is_dropped)
      kept.insert(path.from->path->content);
  EXPECT_EQ(kept, smallest);
  const PairChange& change = made.changes.at({.task_id = 2, .robot_id = 1});
  EXPECT_EQ(change.paths, 2);
  EXPECT_EQ(change.dropped, 4);
  EXPECT_EQ(change.attempts, 6);
}

TEST_F(BatchPlanTest, AStoredPathGoesForASmallerOne) {
  const PreparedAttempt& only = add(1, 1);
  Digest largest = only.path->content;
  largest.bytes.fill(0xFF);
  pair().paths = 1;
  pair().largest.insert({largest, 7, 99});
  const BatchPlan made = plan(1);
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Stored);
  ASSERT_EQ(made.dropped.size(), 1U);
  EXPECT_EQ(made.dropped[0].id, 7);
  EXPECT_EQ(made.dropped[0].crc_when_dropped, 99U);
}

TEST_F(BatchPlanTest, APathThatWasRetiredBeforeItCameIsNotInUse) {
  const PreparedAttempt& only = add(1, 1);
  known_.retired.insert(only.attempt.report_uuid);
  const BatchPlan made = plan(1);
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Recorded);
  ASSERT_EQ(made.paths.size(), 1U);
  EXPECT_TRUE(made.paths[0].is_retired);
  const PairChange& change = made.changes.at({.task_id = 2, .robot_id = 1});
  EXPECT_EQ(change.paths, 0);
  EXPECT_FALSE(change.is_changed);
}

TEST_F(BatchPlanTest, ADamagedPathIsReplacedByTheReportThatBringsItsContent) {
  const PreparedAttempt& again = add(1, 1);
  pair().paths = 1;
  pair().contents[again.path->content] = {.id = 7, .is_readable = false};
  EarlierReport earlier = came_before(again);
  earlier.path_id = 7;
  earlier.is_path_vouched_for = false;
  known_.reports[again.attempt.report_uuid] = earlier;
  const BatchPlan made = plan();
  EXPECT_EQ(made.receipts[0].status, ReceiptStatus::Stored);
  ASSERT_EQ(made.damaged.size(), 1U);
  EXPECT_EQ(made.damaged[0].id, 7);
  ASSERT_EQ(made.paths.size(), 1U);
  EXPECT_EQ(made.damaged[0].replaced_by, made.paths[0].id);
  EXPECT_EQ(made.paths[0].received_ms, 5) << "when it came first";
  ASSERT_EQ(made.mended.size(), 1U);
  const PairChange& change = made.changes.at({.task_id = 2, .robot_id = 1});
  EXPECT_EQ(change.paths, 0) << "one out, one in";
  EXPECT_EQ(change.attempts, 0);
  EXPECT_TRUE(change.is_changed);
}

TEST_F(BatchPlanTest, AnUnknownRobotAndAWrongNumberOfJointsAreAnsweredAlone) {
  add(1, 1);
  Attempt wide = test::make_attempt(robot_.digest, "shelf", 2);
  wide.path = test::make_path(2, test::kDof + 1);
  prepared_.push_back(prepare(std::move(wide)).value_or_throw());
  batch_.push_back(&prepared_.back());
  prepared_.push_back(
      prepare(test::make_attempt(test::id_from<Digest>(99), "shelf", 3)).value_or_throw());
  batch_.push_back(&prepared_.back());
  EXPECT_EQ(
      test::statuses(plan().receipts),
      (std::vector{ReceiptStatus::Stored, ReceiptStatus::Refused, ReceiptStatus::UnknownRobot}));
}

}  // namespace
}  // namespace kinship::store::postgres::batch_plan_test
