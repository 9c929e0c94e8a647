#include <future>

#include "server/store/values/clock.hpp"
#include "tests/support/random_values.hpp"
#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

constexpr std::int64_t kMillisecondsOfADay = std::int64_t{24} * 3600 * 1000;

/// Some 700 bytes, as of a robot with 7 joints.
SearchRecord make_search(std::uint64_t number) {
  test::RandomValues values(number);
  SearchRecord search;
  search.start = values.matrix(test::kDof, 1);
  search.goals = values.matrix(test::kDof, 20);
  search.T_task_goal = test::make_pose();
  search.blockers = {{"link4", "shelf", 60 + number}};
  search.goal_contacts = {{3, "hand", "shelf"}};
  search.last_free = values.matrix(test::kDof, 1);
  search.trees = {{values.matrix(test::kDof, 3).cast<float>(), {-1, 0, 1}}};
  search.allowed_collisions = {{"hand", "can"}};
  search.seed = number;
  search.reason = "not solved within 10 s";
  return search;
}

Attempt failed(const Digest& robot, std::uint64_t number, const std::string& task = "shelf") {
  Attempt attempt = test::make_unsolved(robot, task, number);
  attempt.search = make_search(number);
  return attempt;
}

std::vector<Uuid> uuids_of(const std::vector<AttemptSummary>& summaries) {
  std::vector<Uuid> uuids;
  for (const AttemptSummary& summary : summaries)
    uuids.push_back(summary.report_uuid);
  return uuids;
}

bool has_search(const Store& store, const Attempt& attempt) {
  return store.find_attempt(attempt.report_uuid)->search.has_value();
}

void carry(Store& store, std::vector<ReplicatedReport> reports) {
  std::promise<void> done;
  store.commit_replicated(std::move(reports),
                          [&](const std::vector<Receipt>&) { done.set_value(); });
  done.get_future().get();
}

TEST_P(StoreConformance, ASearchRecordComesBackAsItWas) {
  const Attempt was = failed(panda_.digest, 1);
  EXPECT_EQ(report(was), ReceiptStatus::Recorded);
  reopen();
  const std::optional<SearchRecord> is = store_->find_attempt(was.report_uuid)->search;
  ASSERT_TRUE(is);
  EXPECT_EQ(is->start, was.search->start);
  EXPECT_EQ(is->goals, was.search->goals);
  EXPECT_EQ(is->last_free, was.search->last_free);
  EXPECT_FALSE(is->T_task_start);
  EXPECT_TRUE(is->T_task_goal->isApprox(*was.search->T_task_goal, 1e-15));
  EXPECT_EQ(is->blockers.at(0).count, 61U);
  EXPECT_EQ(is->goal_contacts.at(0).goal, 3U);
  EXPECT_EQ(is->trees.at(0).configurations, was.search->trees[0].configurations);
  EXPECT_EQ(is->trees.at(0).parents, was.search->trees[0].parents);
  EXPECT_EQ(is->allowed_collisions, was.search->allowed_collisions);
  EXPECT_EQ(is->seed, 1U);
  EXPECT_EQ(is->reason, was.search->reason);
  EXPECT_GT(store_->status().search_bytes, 500U);
}

TEST_P(StoreConformance, ASearchRecordIsNoPartOfWhatMakesAReportADuplicate) {
  Attempt attempt = solved(1);
  attempt.search = make_search(1);
  EXPECT_EQ(report(attempt), ReceiptStatus::Stored);
  attempt.search = make_search(2);
  EXPECT_EQ(report(attempt), ReceiptStatus::Duplicate);
  attempt.search.reset();
  EXPECT_EQ(report(attempt), ReceiptStatus::Duplicate);
  EXPECT_EQ(store_->find_attempt(attempt.report_uuid)->search->seed, 1U) << "the first stays";
}

TEST_P(StoreConformance, AttemptsAreFoundByOutcomeTimeAndCost) {
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 1; number <= 6; ++number) {
    Attempt& attempt = attempts.emplace_back(
        number % 2 == 0 ? failed(number == 6 ? iiwa_.digest : panda_.digest, number)
                        : solved(number));
    attempt.record.planning_time_s = static_cast<double>((number * 5) % 7);
  }
  test::report(*store_, attempts);
  const auto found = [&](const WantedAttempts& wanted, const std::string& cursor = "") {
    return uuids_of(store_->find_attempts(wanted, cursor, 10).rows);
  };
  const auto uuid = [&](std::size_t number) { return attempts.at(number - 1).report_uuid; };
  EXPECT_EQ(found({}), (std::vector{uuid(6), uuid(5), uuid(4), uuid(3), uuid(2), uuid(1)}));
  EXPECT_EQ(found({.filter = {.outcome = OutcomeFilter::Unsolved}}),
            (std::vector{uuid(6), uuid(4), uuid(2)}));
  EXPECT_EQ(found({.robot = panda_.digest, .filter = {.outcome = OutcomeFilter::Timeout}}),
            (std::vector{uuid(4), uuid(2)}));
  EXPECT_TRUE(found({.filter = {.outcome = OutcomeFilter::Failed}}).empty());
  EXPECT_EQ(found({.task = "shelf",
                   .filter = {.outcome = OutcomeFilter::Solved, .order = AttemptOrder::Slowest}}),
            (std::vector{uuid(1), uuid(5), uuid(3)}));
  EXPECT_TRUE(found({.filter = {.since_ms = now_ms() + 60'000}}).empty());
  EXPECT_EQ(found({.filter = {.since_ms = now_ms() - 60'000}}).size(), 6U);
  const Page<AttemptSummary> first = store_->find_attempts({}, "", 4);
  EXPECT_EQ(first.rows.size(), 4U);
  EXPECT_EQ(found({}, first.next_cursor), (std::vector{uuid(2), uuid(1)}));
  EXPECT_TRUE(first.rows[0].has_search);
  EXPECT_EQ(first.rows[0].why, why_text(*attempts[5].search));
  EXPECT_EQ(first.rows[0].label, "iiwa");
  EXPECT_FALSE(first.rows[1].has_search);
}

TEST_P(StoreConformance, TheOldestSearchRecordsMakeRoomAndTheirAttemptsStay) {
  reopen({.searches = {.bytes = 5000}});
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 1; number <= 30; ++number) {
    attempts.push_back(failed(panda_.digest, number));
    EXPECT_EQ(report(attempts.back()), ReceiptStatus::Recorded);
  }
  report(solved(31));  // behind the last of them that made room
  EXPECT_FALSE(has_search(*store_, attempts.front()));
  EXPECT_TRUE(has_search(*store_, attempts.back()));
  std::size_t kept = 0;
  for (const Attempt& attempt : attempts)
    kept += has_search(*store_, attempt) ? 1U : 0U;
  EXPECT_GE(kept, 2U);
  EXPECT_LE(kept, 9U);
  EXPECT_EQ(store_->status().attempts, 31U);
  EXPECT_LE(store_->status().search_bytes, 5000U);
  EXPECT_EQ(store_->status().max_search_bytes, 5000U);
}

TEST_P(StoreConformance, OldSearchRecordsGoByTheirDaysAndNoneIsKeptWithoutRoom) {
  reopen({.searches = {.days = 30}});
  const Attempt old = failed(panda_.digest, 1), recent = failed(panda_.digest, 2);
  for (const auto& [attempt, days] : {std::pair(&old, 31), std::pair(&recent, 29)}) {
    ReplicatedReport carried;
    carried.attempt = *attempt;
    carried.body = test::id_from<Digest>(static_cast<std::uint64_t>(days));
    carried.received_ms = now_ms() - days * kMillisecondsOfADay;
    carry(*store_, {carried});
  }
  EXPECT_TRUE(has_search(*store_, recent));
  reopen({.searches = {.days = 30}});
  report(failed(panda_.digest, 3));  // the first one after an opening is followed by a look
  report(solved(4));
  EXPECT_FALSE(has_search(*store_, old));
  EXPECT_TRUE(has_search(*store_, recent));
  reopen({.searches = {.bytes = 0}});
  const Attempt unkept = failed(panda_.digest, 5);
  EXPECT_EQ(report(unkept), ReceiptStatus::Recorded);
  EXPECT_FALSE(has_search(*store_, unkept));
}

TEST_P(StoreConformance, ASearchRecordGoesWithItsPathItsTaskAndItsRobot) {
  Attempt path = solved(1);
  path.search = make_search(1);
  const Attempt of_task = failed(panda_.digest, 2), elsewhere = failed(panda_.digest, 3, "table"),
                of_robot = failed(iiwa_.digest, 4, "table");
  test::report(*store_, {path, of_task, elsewhere, of_robot});
  EXPECT_TRUE(store_->retire_path(path.report_uuid));
  EXPECT_FALSE(has_search(*store_, path));
  EXPECT_TRUE(has_search(*store_, of_task));
  EXPECT_TRUE(store_->reset_task("shelf"));
  EXPECT_FALSE(has_search(*store_, of_task));
  EXPECT_TRUE(has_search(*store_, elsewhere));
  EXPECT_TRUE(store_->remove_robot(iiwa_.digest, {}, nullptr));
  EXPECT_FALSE(has_search(*store_, of_robot));
  EXPECT_TRUE(has_search(*store_, elsewhere));
}

TEST_P(StoreBackup, ABackupHasTheSearchRecords) {
  const Attempt attempt = failed(panda_.digest, 1);
  report(attempt);
  const test::TemporaryDirectory elsewhere;
  ASSERT_TRUE(store_->backup(elsewhere / "store.db", [](double) { return true; }).value_or_throw());
  const std::unique_ptr<Store> copy = GetParam().open(elsewhere.path(), {});
  EXPECT_EQ(copy->find_attempt(attempt.report_uuid)->search->goals, attempt.search->goals);
}

TEST_P(StoreSharing, ASearchRecordIsShared) {
  const Attempt attempt = failed(panda_.digest, 1);
  report(attempt);
  carry(*other_, {shared(attempt.report_uuid)});
  EXPECT_EQ(other_->find_attempt(attempt.report_uuid)->search->goals, attempt.search->goals);
}

}  // namespace
}  // namespace kinship::store
