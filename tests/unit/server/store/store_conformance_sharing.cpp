#include <algorithm>
#include <future>
#include <map>

#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

constexpr PathRange kAllPaths{.after_id = 0, .limit = 1000};

std::vector<Receipt> commit(Store& store, std::vector<ReplicatedReport> reports) {
  std::promise<std::vector<Receipt>> receipts;
  store.commit_replicated(std::move(reports), [&](const std::vector<Receipt>& answered) {
    receipts.set_value(answered);
  });
  return receipts.get_future().get();
}

std::vector<Uuid> all_arrivals(const Store& store, const std::string& task, std::size_t limit) {
  std::vector<Uuid> reports;
  Feed<ArrivedReport> feed;
  do {
    feed = store.list_arrivals(task, feed.cursor, limit);
    for (const ArrivedReport& row : feed.rows)
      reports.push_back(row.report_uuid);
  } while (feed.has_more);
  return reports;
}

TEST_P(StoreSharing, RefusesAttemptsOfAnotherStoreThatBreakARule) {
  Attempt no_path = solved(1);
  no_path.path.reset();
  Attempt failed_with_path = solved(2);
  failed_with_path.record.outcome = Outcome::Failed;
  Attempt share = solved(3);
  share.record.share = 1.5;
  Attempt far_away = solved(4);
  far_away.T_task_base->translation().x() = 1e6;
  std::vector<ReplicatedReport> reports;
  for (const Attempt& attempt : {no_path, failed_with_path, share, far_away, solved(5)})
    reports.push_back({.attempt = attempt});
  const std::vector<Receipt> receipts = commit(*store_, std::move(reports));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(receipts[i].status, ReceiptStatus::Refused) << i;
    EXPECT_FALSE(receipts[i].message.empty()) << i;
  }
  EXPECT_EQ(receipts[4].status, ReceiptStatus::Stored);
  EXPECT_EQ(store_->status().attempts, 1U);
}

TEST_P(StoreSharing, ArrivalsAreOfAllKindsInTheirOrderAndGoOnBehindACursor) {
  report(solved(3));
  report(test::make_unsolved(iiwa_.digest, "table", 1));
  report(solved(2));
  ASSERT_TRUE(store_->retire_path(solved(3).report_uuid));
  const Feed<ArrivedReport> feed = store_->list_arrivals("", "", 10);
  ASSERT_EQ(feed.rows.size(), 3U);
  EXPECT_FALSE(feed.has_more);
  EXPECT_EQ(feed.rows[0].report_uuid, solved(3).report_uuid);
  EXPECT_TRUE(feed.rows[0].is_retired);
  EXPECT_EQ(feed.rows[1].report_uuid, test::id_from<Uuid>(1));
  EXPECT_FALSE(feed.rows[1].is_retired);
  EXPECT_FALSE(feed.rows[2].is_retired);
  EXPECT_TRUE(store_->list_arrivals("", feed.cursor, 10).rows.empty());
  report(solved(4));
  const Feed<ArrivedReport> next = store_->list_arrivals("", feed.cursor, 10);
  ASSERT_EQ(next.rows.size(), 1U);
  EXPECT_EQ(next.rows[0].report_uuid, solved(4).report_uuid);
  EXPECT_EQ(store_->list_arrivals("", next.cursor, 10).cursor, next.cursor);
  EXPECT_THROW(static_cast<void>(store_->list_arrivals("", "somewhere", 10)), Failure);
}

TEST_P(StoreSharing, ArrivalsOfATaskAreThoseOfAllItsRobots) {
  std::vector<Uuid> wanted;
  for (std::uint64_t number = 1; number <= 9; ++number) {
    report(solved(100 + number));
    const Attempt other =
        test::make_attempt(number % 2 == 0 ? panda_.digest : iiwa_.digest, "table", number);
    report(other);
    wanted.push_back(other.report_uuid);
  }
  for (const std::size_t limit : {1U, 4U, 100U})
    EXPECT_EQ(all_arrivals(*store_, "table", limit), wanted) << "pages of " << limit;
  EXPECT_EQ(all_arrivals(*store_, "", 5).size(), 18U);
  EXPECT_TRUE(all_arrivals(*store_, "nobody's", 5).empty());
}

TEST_P(StoreSharing, AReportIsTheSameInTheOtherStore) {
  Attempt attempt = solved(1);
  attempt.scene = RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}}}, {}, {}};
  report(attempt);
  const ReplicatedReport sent = shared(attempt.report_uuid);
  EXPECT_EQ(commit(*other_, {sent}).at(0).status, ReceiptStatus::Stored);
  const Attempt kept = other_->find_attempt(attempt.report_uuid).value();
  EXPECT_EQ(kept.machine, attempt.machine);
  EXPECT_EQ(kept.path->waypoints(), attempt.path->waypoints());
  EXPECT_EQ(content_digest(*kept.scene), content_digest(*attempt.scene));
  const AttemptSummary here = store_->list_attempts({}, "", "", 1).rows.at(0);
  EXPECT_EQ(other_->list_attempts({}, "", "", 1).rows.at(0).received_ms, here.received_ms);
  const ReplicatedReport back =
      other_->read_reports(std::vector{attempt.report_uuid}, kManyBytes).reports.at(0);
  EXPECT_EQ(back.body, sent.body);
  EXPECT_EQ(back.received_ms, sent.received_ms);
  EXPECT_EQ(commit(*store_, {back}).at(0).status, ReceiptStatus::Duplicate);
  EXPECT_EQ(test::report(*other_, {attempt}).at(0).status, ReceiptStatus::Duplicate)
      << "its robot may turn to the other one";
}

TEST_P(StoreSharing, AReportKeepsTheTimeItCame) {
  report(solved(1));
  ReplicatedReport sent = shared(solved(1).report_uuid);
  sent.received_ms -= 86'400'000;
  commit(*other_, {sent});
  EXPECT_EQ(other_->list_attempts({}, "", "", 1).rows.at(0).received_ms, sent.received_ms);
  EXPECT_EQ(other_->read_paths(panda_.digest, "shelf", kAllPaths).at(0).received_ms,
            sent.received_ms);
}

TEST_P(StoreSharing, OneUuidIsOneReportInAllStores) {
  report(solved(1));
  Attempt other = solved(2);
  other.report_uuid = solved(1).report_uuid;
  test::report(*other_, {other});
  EXPECT_EQ(commit(*other_, {shared(solved(1).report_uuid)}).at(0).status, ReceiptStatus::Refused);
}

TEST_P(StoreSharing, WhatIsKnownIsToldFromWhatIsNot) {
  report(solved(1));
  report(test::make_unsolved(panda_.digest, "shelf", 2));
  const std::vector<Uuid> asked = {solved(1).report_uuid, test::id_from<Uuid>(2),
                                   test::id_from<Uuid>(3)};
  const ReplicatedReports read = store_->read_reports(asked, kManyBytes);
  EXPECT_EQ(read.looked_at, 3U);
  ASSERT_EQ(read.reports.size(), 2U);
  EXPECT_EQ(
      store_->known_reports(asked),
      (std::map<Uuid, Digest>{{asked[0], read.reports[0].body}, {asked[1], read.reports[1].body}}));
  for (const ArrivedReport& arrived : store_->list_arrivals("", "", 10).rows)
    EXPECT_EQ(arrived.body, store_->known_reports(asked).at(arrived.report_uuid));
  EXPECT_FALSE(read.reports[1].attempt.path);
  const ReplicatedReports few = store_->read_reports(asked, 1);
  EXPECT_EQ(few.looked_at, 1U) << "one at least";
  EXPECT_EQ(few.reports.size(), 1U);
}

TEST_P(StoreSharing, ARetirementIsListedOnceWithAllReportsOfItsContent) {
  report(solved(1));
  Attempt same = solved(1);
  for (const std::uint64_t number : {76U, 77U}) {
    same.report_uuid = test::id_from<Uuid>(number);
    EXPECT_EQ(report(same), ReceiptStatus::Duplicate);
  }
  report(solved(2));
  ASSERT_TRUE(store_->retire_path(same.report_uuid));
  ASSERT_TRUE(store_->retire_path(same.report_uuid));
  reopen();
  const Feed<Uuid> feed = store_->list_retirements("", 10);
  EXPECT_EQ(std::set<Uuid>(feed.rows.begin(), feed.rows.end()),
            (std::set<Uuid>{solved(1).report_uuid, test::id_from<Uuid>(76), same.report_uuid}));
  EXPECT_EQ(feed.rows.size(), 3U);
  ASSERT_TRUE(store_->reset_task("shelf"));
  const Feed<Uuid> next = store_->list_retirements(feed.cursor, 10);
  EXPECT_EQ(next.rows, std::vector<Uuid>{solved(2).report_uuid});
  EXPECT_TRUE(store_->list_retirements(next.cursor, 10).rows.empty());
  EXPECT_TRUE(store_->list_retirements("", 1).has_more);
}

TEST_P(StoreSharing, TheRemovalOfARobotRetiresItsPathsForOthersToo) {
  report(solved(1));
  report(test::make_attempt(iiwa_.digest, "shelf", 2));
  report(test::make_unsolved(panda_.digest, "shelf", 3));
  ASSERT_TRUE(store_->remove_robot(panda_.digest));
  EXPECT_TRUE(is_listed_as_retired(*store_, solved(1).report_uuid));
  EXPECT_FALSE(is_listed_as_retired(*store_, test::id_from<Uuid>(2)));
  const std::vector<Uuid> of_panda = {solved(1).report_uuid, test::id_from<Uuid>(3)};
  EXPECT_TRUE(store_->read_reports(of_panda, kManyBytes).reports.empty());
}

TEST_P(StoreSharing, WhatAnotherStoreRetiredIsRetiredHere) {
  report(solved(1));
  Attempt same = solved(1);
  same.report_uuid = test::id_from<Uuid>(77);
  EXPECT_EQ(report(same), ReceiptStatus::Duplicate);
  report(solved(2));
  report(test::make_attempt(iiwa_.digest, "table", 3));
  const std::uint64_t generation = store_->generation(panda_.digest, "shelf");
  const std::vector<Uuid> reports = {solved(1).report_uuid, test::id_from<Uuid>(3)};
  const std::vector<Retirement> retired = store_->retire_reports(reports);
  ASSERT_EQ(retired.size(), 2U);
  EXPECT_EQ(retired[0].task, "shelf");
  EXPECT_EQ(retired[0].paths, 1U);
  EXPECT_EQ(retired[1].robots, std::vector<Digest>{iiwa_.digest});
  EXPECT_EQ(store_->read_paths(panda_.digest, "shelf", kAllPaths).size(), 1U);
  EXPECT_GT(store_->generation(panda_.digest, "shelf"), generation);
  EXPECT_TRUE(store_->retire_reports(reports).empty()) << "again";
  EXPECT_TRUE(is_listed_as_retired(*store_, solved(1).report_uuid));
  EXPECT_TRUE(is_listed_as_retired(*store_, same.report_uuid)) << "of the same content";
}

TEST_P(StoreSharing, WhatIsRetiredBeforeItComesIsRetiredWhenItComes) {
  EXPECT_TRUE(store_->retire_reports(std::vector{solved(1).report_uuid}).empty());
  reopen();
  const Receipt receipt = test::report(*store_, {solved(1)}).at(0);
  EXPECT_EQ(receipt.status, ReceiptStatus::Recorded) << receipt.message;
  EXPECT_FALSE(receipt.message.empty());
  EXPECT_TRUE(store_->read_paths(panda_.digest, "shelf", kAllPaths).empty());
  EXPECT_EQ(store_->generation(panda_.digest, "shelf"), 0U);
  EXPECT_EQ(store_->status().attempts, 1U);
  EXPECT_EQ(store_->status().paths, 0U);
  EXPECT_EQ(report(solved(1)), ReceiptStatus::Duplicate);
  EXPECT_TRUE(store_->find_attempt(solved(1).report_uuid)->path) << "for the record";
  Attempt anew = solved(1);
  anew.report_uuid = test::id_from<Uuid>(5);
  EXPECT_EQ(report(anew), ReceiptStatus::Stored) << "content may be reported anew";
}

TEST_P(StoreSharing, ARetiredReportComesAsRetiredAndStaysSo) {
  report(solved(1));
  ASSERT_TRUE(store_->retire_path(solved(1).report_uuid));
  const ReplicatedReport sent = shared(solved(1).report_uuid);
  EXPECT_TRUE(sent.is_retired);
  EXPECT_EQ(commit(*other_, {sent}).at(0).status, ReceiptStatus::Recorded);
  EXPECT_TRUE(other_->read_paths(panda_.digest, "shelf", kAllPaths).empty());
  EXPECT_TRUE(is_listed_as_retired(*other_, solved(1).report_uuid)) << "for a third store";
  EXPECT_EQ(test::report(*other_, {solved(1)}).at(0).status, ReceiptStatus::Duplicate);
  EXPECT_TRUE(other_->read_paths(panda_.digest, "shelf", kAllPaths).empty());
}

TEST_P(StoreSharing, WhatIsHereAndComesAsRetiredIsRetired) {
  report(solved(1));
  test::report(*other_, {solved(1)});
  ASSERT_TRUE(store_->retire_path(solved(1).report_uuid));
  EXPECT_EQ(commit(*other_, {shared(solved(1).report_uuid)}).at(0).status,
            ReceiptStatus::Duplicate);
  EXPECT_TRUE(other_->read_paths(panda_.digest, "shelf", kAllPaths).empty());
}

TEST_P(StoreSharing, AReportThatComesAgainAfterItWasRetiredHereStaysRetired) {
  report(solved(1));
  const ReplicatedReport live = shared(solved(1).report_uuid);
  EXPECT_FALSE(live.is_retired);
  ASSERT_TRUE(store_->retire_path(solved(1).report_uuid));
  EXPECT_EQ(commit(*store_, {live}).at(0).status, ReceiptStatus::Duplicate);
  EXPECT_TRUE(store_->read_paths(panda_.digest, "shelf", kAllPaths).empty());
}

TEST_P(StoreSharing, AReportOfAnUnknownRobotIsNotRefusedForGood) {
  RobotRecord third = test::make_robot("third", 3);
  ASSERT_TRUE(store_->register_robot(third));
  test::report(*store_, {test::make_attempt(third.digest, "shelf", 1)});
  EXPECT_EQ(commit(*other_, {shared(test::id_from<Uuid>(1))}).at(0).status,
            ReceiptStatus::UnknownRobot);
}

TEST_P(StoreSharing, ADroppedPathIsNeitherRetiredNorSent) {
  reopen({.paths_per_pair = 1});
  report(solved(1));
  report(solved(2));
  const std::size_t kept = store_->read_paths(panda_.digest, "shelf", kAllPaths).size();
  ASSERT_EQ(kept, 1U);
  const Feed<ArrivedReport> feed = store_->list_arrivals("", "", 10);
  ASSERT_EQ(feed.rows.size(), 2U);
  EXPECT_FALSE(feed.rows[0].is_retired || feed.rows[1].is_retired);
  EXPECT_TRUE(store_->list_retirements("", 10).rows.empty());
  const ReplicatedReports read = store_->read_reports(
      std::vector{feed.rows[0].report_uuid, feed.rows[1].report_uuid}, kManyBytes);
  EXPECT_EQ(read.looked_at, 2U);
  EXPECT_EQ(read.reports.size(), 1U);
}

TEST_P(StoreSharing, NotesAreKeptByName) {
  store_->put_notes({{"sites.up", "12"}, {"sites.down.shelf", "7"}, {"other", "x"}});
  store_->put_notes({{"sites.up", "13"}, {"sites.down.shelf", std::nullopt}, {"sites.new", ""}});
  reopen();
  EXPECT_EQ(store_->notes("sites."),
            (std::map<std::string, std::string>{{"sites.new", ""}, {"sites.up", "13"}}));
  EXPECT_EQ(store_->notes("").size(), 3U);
  EXPECT_TRUE(store_->notes("a").empty());
}

}  // namespace
}  // namespace kinship::store
