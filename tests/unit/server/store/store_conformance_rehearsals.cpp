#include <limits>

#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

std::vector<Digest> ids_of(const std::vector<StoredRehearsal>& rehearsals) {
  std::vector<Digest> ids;
  for (const StoredRehearsal& rehearsal : rehearsals)
    ids.push_back(rehearsal.id);
  return ids;
}

void expect_equal(const RecallLibrary& is, const RecallLibrary& was) {
  EXPECT_EQ(is.revision, was.revision);
  EXPECT_EQ(is.search_checks, was.search_checks);
  EXPECT_EQ(is.try_checks, was.try_checks);
  EXPECT_EQ(is.anchors, was.anchors);
  EXPECT_EQ(is.modes, was.modes);
  EXPECT_EQ(is.solves, was.solves);
  EXPECT_EQ(is.reaches, was.reaches);
  ASSERT_EQ(is.queries.size(), was.queries.size());
  for (std::size_t i = 0; i < is.queries.size(); ++i) {
    EXPECT_EQ(is.queries[i].report, was.queries[i].report);
    EXPECT_EQ(is.queries[i].is_synthetic, was.queries[i].is_synthetic);
    EXPECT_TRUE(is.queries[i].T_task_base.isApprox(was.queries[i].T_task_base, 1e-15));
    EXPECT_EQ(is.queries[i].start, was.queries[i].start);
    EXPECT_EQ(is.queries[i].goal, was.queries[i].goal);
    ASSERT_EQ(is.queries[i].T_task_anchors.size(), was.queries[i].T_task_anchors.size());
    EXPECT_TRUE(is.queries[i].T_task_anchors[0].isApprox(was.queries[i].T_task_anchors[0], 1e-15));
  }
  ASSERT_EQ(is.paths.size(), was.paths.size());
  for (std::size_t i = 0; i < is.paths.size(); ++i) {
    EXPECT_EQ(is.paths[i].query, was.paths[i].query);
    EXPECT_EQ(is.paths[i].waypoints, was.paths[i].waypoints);
  }
}

TEST_P(StoreConformance, GivesARehearsalBackAsItWas) {
  const StoredRehearsal was = test::make_rehearsal(panda_.digest, "shelf", 1);
  store_->put_rehearsal(was);
  reopen();
  const std::vector<StoredRehearsal> read = store_->read_rehearsals(10);
  ASSERT_EQ(read.size(), 1U);
  const StoredRehearsal& is = read[0];
  EXPECT_EQ(is.id, was.id);
  EXPECT_EQ(is.robot, was.robot);
  EXPECT_EQ(is.task, was.task);
  EXPECT_EQ(is.made_ms, was.made_ms);
  EXPECT_EQ(is.kind, was.kind);
  EXPECT_EQ(is.paths, was.paths);
  EXPECT_EQ(is.retired, was.retired);
  ASSERT_TRUE(is.T_task_base);
  EXPECT_TRUE(is.T_task_base->isApprox(*was.T_task_base, 1e-15));
  EXPECT_EQ(is.rehearsal, was.rehearsal);
  ASSERT_TRUE(is.library);
  expect_equal(*is.library, *was.library);
}

TEST_P(StoreConformance, ARehearsalNeedsNoLibraryPlacementOrRobot) {
  StoredRehearsal was = test::make_rehearsal(test::id_from<Digest>(9), "never reported", 1);
  was.library.reset();
  was.T_task_base.reset();
  store_->put_rehearsal(was);
  const std::vector<StoredRehearsal> read = store_->read_rehearsals(10);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_FALSE(read[0].library);
  EXPECT_FALSE(read[0].T_task_base);
}

TEST_P(StoreConformance, TheLastRehearsalOfADistributionCountsAndTheNewestComesFirst) {
  std::vector<StoredRehearsal> rehearsals;
  for (std::uint64_t number = 1; number <= 3; ++number)
    rehearsals.push_back(test::make_rehearsal(panda_.digest, "shelf", number));
  for (const StoredRehearsal& rehearsal : rehearsals)
    store_->put_rehearsal(rehearsal);
  rehearsals[1].paths = 1234;
  store_->put_rehearsal(rehearsals[1]);
  const std::vector<StoredRehearsal> read = store_->read_rehearsals(10);
  EXPECT_EQ(ids_of(read), (std::vector{rehearsals[1].id, rehearsals[2].id, rehearsals[0].id}));
  EXPECT_EQ(read.at(0).paths, 1234U);
  EXPECT_EQ(ids_of(store_->read_rehearsals(2)), (std::vector{rehearsals[1].id, rehearsals[2].id}));
}

TEST_P(StoreConformance, RehearsalsGoWithTheNameOfTheirTask) {
  const StoredRehearsal other = test::make_rehearsal(panda_.digest, "table", 1);
  const auto put_all = [&] {
    store_->put_rehearsal(other);
    for (std::uint64_t number = 2; number <= 4; ++number)
      store_->put_rehearsal(
          test::make_rehearsal(panda_.digest, number < 4 ? "shelf" : "rack", number));
  };
  report(solved(1));
  put_all();
  ASSERT_TRUE(store_->rename_task("shelf", "rack"));
  EXPECT_EQ(ids_of(store_->read_rehearsals(10)), std::vector{other.id}) << "of a former rack too";
  report(solved(2));
  put_all();
  ASSERT_TRUE(store_->remove_task("shelf"));
  EXPECT_EQ(store_->read_rehearsals(10).size(), 2U);
}

TEST_P(StoreConformance, TheOldestRehearsalsMakeRoom) {
  const auto put = [this](std::uint64_t number, const RehearsalLimits& limits) {
    const StoredRehearsal rehearsal = test::make_rehearsal(panda_.digest, "shelf", number);
    store_->put_rehearsal(rehearsal, limits);
    return rehearsal.id;
  };
  constexpr std::uint64_t kBytes = 3000;  // a rehearsal has between 1 and 1.5 KB
  std::vector<Digest> ids;
  for (std::uint64_t number = 1; number <= 5; ++number)
    ids.push_back(put(number, {.count = 3}));
  EXPECT_EQ(ids_of(store_->read_rehearsals(10)), (std::vector{ids[4], ids[3], ids[2]}));
  ids.push_back(put(6, {.bytes = kBytes}));
  EXPECT_EQ(ids_of(store_->read_rehearsals(10)), (std::vector{ids[5], ids[4]}));
  ids.push_back(put(7, {.bytes = 1}));
  EXPECT_EQ(ids_of(store_->read_rehearsals(10)), std::vector{ids[6]}) << "never the newest";
}

TEST_P(StoreConformance, ARehearsalThatCouldNotBeReadBackIsRefused) {
  StoredRehearsal bad = test::make_rehearsal(panda_.digest, "shelf", 1);
  bad.library->paths[0].waypoints(0, 0) = std::numeric_limits<double>::infinity();
  try {
    store_->put_rehearsal(bad);
    ADD_FAILURE() << "it was stored";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::InvalidInput);
  }
  EXPECT_TRUE(store_->read_rehearsals(10).empty());
}

TEST_P(StoreBackup, ABackupHasTheRehearsals) {
  const StoredRehearsal rehearsal = test::make_rehearsal(panda_.digest, "shelf", 1);
  store_->put_rehearsal(rehearsal);
  const test::TemporaryDirectory elsewhere;
  ASSERT_TRUE(store_->backup(elsewhere / "store.db", [](double) { return true; }).value_or_throw());
  const std::unique_ptr<Store> copy = GetParam().open(elsewhere.path(), {});
  EXPECT_EQ(ids_of(copy->read_rehearsals(10)), std::vector{rehearsal.id});
}

}  // namespace
}  // namespace kinship::store
