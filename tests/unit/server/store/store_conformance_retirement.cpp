#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

constexpr PathRange kAll{.after_id = 0, .limit = 1000};

TEST_P(StoreConformance, ARetiredPathIsInNoFitButOnRecord) {
  test::report(*store_, {solved(1), solved(2), solved(3)});
  const Result<Retirement> retired = store_->retire_path(solved(2).report_uuid);
  ASSERT_TRUE(retired) << retired.error().message;
  EXPECT_EQ(retired->task, "shelf");
  EXPECT_EQ(retired->paths, 1U);
  EXPECT_EQ(retired->robots, std::vector<Digest>{panda_.digest});
  reopen();
  const std::vector<StoredPath> left = store_->read_paths(panda_.digest, "shelf", kAll);
  ASSERT_EQ(left.size(), 2U);
  EXPECT_EQ(left[0].report_uuid, solved(1).report_uuid);
  EXPECT_EQ(left[1].report_uuid, solved(3).report_uuid);
  EXPECT_EQ(store_->status().paths, 2U);
  EXPECT_EQ(store_->status().attempts, 3U);
  EXPECT_EQ(store_->find_task("shelf")->paths, 2U);
  EXPECT_EQ(store_->find_attempt(solved(2).report_uuid)->path->waypoints(),
            solved(2).path->waypoints());
  const std::vector<PathSummary> listed = store_->list_paths({}, "", "", 10).rows;
  ASSERT_EQ(listed.size(), 3U);
  EXPECT_EQ(listed[0].retired_ms, 0);
  EXPECT_GE(listed[1].retired_ms, listed[1].received_ms);
  EXPECT_EQ(listed[1].report_uuid, solved(2).report_uuid);
}

TEST_P(StoreConformance, ARenamedTaskKeepsEverythingButItsName) {
  test::report(*store_, {solved(1), solved(2)});
  report(test::make_attempt(panda_.digest, "table", 3));
  ASSERT_TRUE(store_->rename_task("shelf", "rack"));
  reopen();
  EXPECT_FALSE(store_->find_task("shelf"));
  EXPECT_EQ(store_->find_task("rack")->paths, 2U);
  EXPECT_EQ(store_->find_attempt(solved(1).report_uuid)->task, "rack");
  EXPECT_EQ(report(solved(1)), ReceiptStatus::Duplicate) << "under its old name";
  EXPECT_FALSE(store_->find_task("shelf"));
  EXPECT_EQ(store_->rename_task("rack", "table").error().code, ErrorCode::Conflict);
  EXPECT_EQ(store_->rename_task("shelf", "rack").error().code, ErrorCode::NotFound);
  EXPECT_EQ(report(solved(4)), ReceiptStatus::Stored);
  EXPECT_EQ(store_->find_task("shelf")->paths, 1U);
}

TEST_P(StoreConformance, AKnownReportIsOfTheTaskOfItsAttemptWhateverItNames) {
  report(solved(1));
  ASSERT_TRUE(store_->rename_task("shelf", "rack"));
  // In one batch with a report that begins a task of the old name.
  const std::vector<Receipt> receipts = test::report(*store_, {solved(1), solved(2), solved(1)});
  EXPECT_EQ(receipts[0].status, ReceiptStatus::Duplicate);
  EXPECT_EQ(receipts[1].status, ReceiptStatus::Stored);
  EXPECT_EQ(receipts[2].status, ReceiptStatus::Duplicate);
  EXPECT_EQ(store_->find_task("rack")->attempts, 1U);
  EXPECT_EQ(store_->find_task("shelf")->attempts, 1U);
  ASSERT_TRUE(store_->rename_task("shelf", "table"));
  EXPECT_EQ(test::report(*store_, {solved(2), solved(1)})[0].status, ReceiptStatus::Duplicate);
  EXPECT_EQ(store_->list_tasks("", 10).rows.size(), 2U);
}

TEST_P(StoreConformance, ARemovedTaskIsOnRecordAndListedAgainWithItsNextAttempt) {
  test::report(*store_, {solved(1), solved(2)});
  report(test::make_attempt(panda_.digest, "table", 3));
  const Result<RemovedTask> removed = store_->remove_task("shelf");
  ASSERT_TRUE(removed) << removed.error().message;
  EXPECT_EQ(removed->removal.paths, 2U);
  EXPECT_EQ(removed->removal.attempts, 2U);
  reopen();
  EXPECT_FALSE(store_->find_task("shelf"));
  const std::vector<TaskSummary> listed = store_->list_tasks("", 10).rows;
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_EQ(listed[0].task, "table");
  EXPECT_TRUE(store_->find_attempt(solved(1).report_uuid));
  EXPECT_EQ(report(solved(1)), ReceiptStatus::Duplicate);
  EXPECT_FALSE(store_->find_task("shelf")) << "a report that is known is no news";
  EXPECT_EQ(report(test::make_unsolved(panda_.digest, "shelf", 4)), ReceiptStatus::Recorded);
  EXPECT_EQ(store_->find_task("shelf")->attempts, 3U);
  EXPECT_EQ(store_->remove_task("nothing").error().code, ErrorCode::NotFound);
}

TEST_P(StoreConformance, ThatATaskWasRemovedHidesNoOtherOfItsName) {
  std::uint64_t number = 0;
  const auto report_more = [&](const std::string& task, int count) {
    for (int i = 0; i < count; ++i)
      report(test::make_attempt(panda_.digest, task, ++number));
  };
  report_more("lod", 3);
  ASSERT_TRUE(store_->remove_task("lod"));
  report_more("lod", 1);
  ASSERT_TRUE(store_->rename_task("lod", "load"));
  report_more("lod", 3);
  ASSERT_TRUE(store_->find_task("lod")) << "as many attempts as the removed one had";
  ASSERT_TRUE(store_->rename_task("lod", "lode"));
  report_more("table", 3);
  ASSERT_TRUE(store_->rename_task("table", "lod"));
  EXPECT_TRUE(store_->find_task("lod"));
  EXPECT_EQ(store_->list_tasks("", 10).rows.size(), 3U);
  ASSERT_TRUE(store_->remove_task("lode"));
  EXPECT_FALSE(store_->find_task("lode"));
  EXPECT_EQ(store_->list_tasks("", 10).rows.size(), 2U);
}

TEST_P(StoreConformance, ReportsAreFoundByTheBeginningOfTheirUuid) {
  test::report(*store_, {solved(1), solved(2), solved(3)});
  const Uuid one = solved(1).report_uuid, three = solved(3).report_uuid;
  EXPECT_EQ(store_->reports_between(one, one, 2), std::vector{one});
  EXPECT_EQ(store_->reports_between(one, three, 9).empty(), three < one);
  Uuid last;
  last.bytes.fill(0xFF);
  EXPECT_EQ(store_->reports_between(Uuid(), last, 9).size(), 3U);
  EXPECT_EQ(store_->reports_between(Uuid(), last, 2).size(), 2U);
}

TEST_P(StoreConformance, TheLastRetirementOfARobotStaysToBeSeen) {
  report(solved(1));
  ASSERT_TRUE(store_->retire_path(solved(1).report_uuid));
  const std::vector<ExperienceSummary> experience = store_->experience("shelf");
  ASSERT_EQ(experience.size(), 1U);
  EXPECT_EQ(experience[0].paths, 0U);
  EXPECT_EQ(experience[0].generation, 2U);
  EXPECT_EQ(experience[0].retired_generation, 2U);
}

TEST_P(StoreConformance, OnlyAPathCanBeRetired) {
  report(test::make_unsolved(panda_.digest, "shelf", 1));
  const Result<Retirement> unsolved = store_->retire_path(test::id_from<Uuid>(1));
  ASSERT_FALSE(unsolved);
  EXPECT_EQ(unsolved.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(unsolved.error().message.find(test::id_from<Uuid>(1).text()), std::string::npos);
  const Result<Retirement> unknown = store_->retire_path(test::id_from<Uuid>(2));
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::NotFound);
}

TEST_P(StoreConformance, AResetTaskLosesAllItsPathsAndNoOtherDoes) {
  for (std::uint64_t i = 1; i <= 3; ++i)
    report(solved(i));
  report(test::make_attempt(iiwa_.digest, "shelf", 4));
  report(test::make_unsolved(iiwa_.digest, "shelf", 5));
  report(test::make_attempt(iiwa_.digest, "table", 6));
  const Result<Retirement> reset = store_->reset_task("shelf");
  ASSERT_TRUE(reset);
  EXPECT_EQ(reset->task, "shelf");
  EXPECT_EQ(reset->paths, 4U);
  EXPECT_EQ(reset->robots.size(), 2U);
  EXPECT_EQ(store_->find_task("shelf")->paths, 0U);
  EXPECT_EQ(store_->find_task("shelf")->attempts, 5U);
  EXPECT_EQ(store_->find_task("table")->paths, 1U);
  for (const ExperienceSummary& summary : store_->experience("shelf"))
    EXPECT_EQ(summary.retired_generation, summary.generation);
  EXPECT_EQ(store_->experience("table")[0].retired_generation, 0U);
  EXPECT_EQ(store_->reset_task("shelf")->paths, 0U);
  EXPECT_EQ(store_->reset_task("nothing").error().code, ErrorCode::NotFound);
}

TEST_P(StoreConformance, AResetOfManyPathsMissesNone) {
  constexpr std::uint64_t kPaths = 1200;
  std::vector<Attempt> attempts;
  for (std::uint64_t i = 0; i < kPaths; ++i)
    attempts.push_back(solved(i));
  test::report(*store_, std::move(attempts));
  EXPECT_EQ(store_->reset_task("shelf")->paths, kPaths);
  EXPECT_EQ(store_->status().paths, 0U);
  EXPECT_TRUE(store_->read_paths(panda_.digest, "shelf", kAll).empty());
}

TEST_P(StoreConformance, AStepOfAResetRetires500PathsOfAllRobotsTogether) {
  constexpr std::uint64_t kPathsOfEach = 300;
  std::vector<Attempt> attempts;
  for (std::uint64_t i = 0; i < kPathsOfEach; ++i) {
    attempts.push_back(solved(i));
    attempts.push_back(test::make_attempt(iiwa_.digest, "shelf", kPathsOfEach + i));
  }
  test::report(*store_, std::move(attempts));
  std::stop_source stop;
  stop.request_stop();
  const Result<Retirement> stopped = store_->reset_task("shelf", stop.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_NE(stopped.error().message.find("after 500 paths"), std::string::npos)
      << stopped.error().message;
  EXPECT_EQ(store_->status().paths, 2 * kPathsOfEach - 500);
  EXPECT_EQ(store_->reset_task("shelf")->paths, 2 * kPathsOfEach - 500);
}

TEST_P(StoreConformance, ListsRetiredPathsInTheirPlace) {
  for (std::uint64_t i = 1; i <= 6; ++i)
    report(solved(i));
  for (const std::uint64_t i : {2U, 3U, 6U})
    ASSERT_TRUE(store_->retire_path(solved(i).report_uuid));
  std::uint64_t number = 7;
  std::string cursor;
  do {
    const Page<PathSummary> page = store_->list_paths(panda_.digest, "", cursor, 2);
    ASSERT_EQ(page.rows.size(), 2U);
    for (const PathSummary& path : page.rows) {
      EXPECT_EQ(path.report_uuid, solved(--number).report_uuid);
      EXPECT_EQ(path.retired_ms > 0, number == 2 || number == 3 || number == 6) << number;
    }
    cursor = page.next_cursor;
  } while (!cursor.empty());
  EXPECT_EQ(number, 1U);
}

TEST_P(StoreConformance, ReadsOnlyPathsThatArrivedSince) {
  report(solved(1));
  const std::int64_t first_ms = store_->read_paths(panda_.digest, "shelf", kAll)[0].received_ms;
  EXPECT_EQ(first_ms, store_->list_paths({}, "", "", 1).rows[0].received_ms);
  std::uint64_t number = 1;
  std::int64_t later_ms = first_ms;
  while (later_ms == first_ms) {  // until the clock has moved on
    report(solved(++number));
    later_ms = store_->read_paths(panda_.digest, "shelf", kAll).back().received_ms;
  }
  const auto count = [this](std::int64_t since_ms) {
    return store_->read_paths(panda_.digest, "shelf", {0, 1000, since_ms}).size();
  };
  EXPECT_EQ(count(0), number);
  EXPECT_EQ(count(first_ms), number);
  EXPECT_EQ(count(later_ms), 1U);
  EXPECT_EQ(count(later_ms + 1), 0U);
}

TEST_P(StoreConformance, AnEvictedDistributionIsGoneAndItsRevisionsGoOn) {
  test::begin_task(*store_, panda_.digest, "shelf");
  const Distribution distribution = test::make_distribution(panda_.digest, "shelf", 1);
  store_->put_distribution(distribution);
  store_->put_distribution(distribution);
  EXPECT_TRUE(store_->evict_distribution(distribution.id));
  EXPECT_FALSE(store_->evict_distribution(distribution.id));
  EXPECT_FALSE(store_->find_distribution(distribution.id));
  EXPECT_TRUE(store_->list_distributions({}, "", "", 10).rows.empty());
  EXPECT_EQ(store_->status().distributions, 0U);
  reopen();
  EXPECT_EQ(store_->put_distribution(distribution), 3U);
  EXPECT_EQ(store_->put_distribution(distribution), 4U);
  EXPECT_TRUE(store_->evict_distribution(distribution.id));
  EXPECT_EQ(store_->put_distribution(distribution), 5U);
  EXPECT_EQ(store_->find_distribution(distribution.id)->revision, 5U);
}

TEST_P(StoreConformance, KeepsWhatAFitWasAskedForAndWhatItsSourcesGave) {
  test::begin_task(*store_, panda_.digest, "shelf");
  Distribution distribution = test::make_distribution(panda_.digest, "shelf", 1);
  distribution.selection = {{panda_.digest, iiwa_.digest}, Weighting::Paths, 1'700'000'000'000};
  distribution.sources[0].relation = Relation::SameArm;
  distribution.sources[0].paths_used = 11;
  distribution.sources[0].mass = 0.75;
  distribution.advice.guided = ModeEvidence{10, 5, 100};
  store_->put_distribution(distribution);
  const std::optional<Distribution> found = store_->find_distribution(distribution.id);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->selection, distribution.selection);
  EXPECT_EQ(found->sources[0].relation, Relation::SameArm);
  EXPECT_EQ(found->sources[0].paths_used, 11U);
  EXPECT_EQ(found->sources[0].mass, 0.75);
  EXPECT_FALSE(found->advice.guided);  // of the moment, not of the fit
}

}  // namespace
}  // namespace kinship::store
