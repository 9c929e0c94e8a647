#include "tests/unit/server/store/store_conformance.hpp"

/// Robots that get another label, and robots that are taken out.
namespace kinship::store {
namespace {

constexpr PathRange kEveryPath{.after_id = 0, .limit = 10'000};

/// `panda` with another description: what a corrected registration brings.
RobotRecord corrected() { return test::make_robot("panda", 3); }

TEST_P(StoreConformance, ARenamedRobotKeepsWhatItHasAndFreesItsLabel) {
  report(solved(1));
  ASSERT_TRUE(store_->rename_robot(panda_.digest, "panda_old"));
  reopen();
  const RobotRecord after = store_->find_robot(panda_.digest).value();
  EXPECT_EQ(after.description.label, "panda_old");
  EXPECT_EQ(after.description.urdf, panda_.description.urdf);
  EXPECT_EQ(after.registered_ms, panda_.registered_ms);
  EXPECT_EQ(store_->robots().size(), 2U);  // undamaged, both
  EXPECT_EQ(store_->list_paths({}, "", "", 10).rows.at(0).label, "panda_old");
  EXPECT_EQ(store_->read_paths(panda_.digest, "shelf", kEveryPath).size(), 1U);
  EXPECT_EQ(*store_->register_robot(corrected()), RegisterStatus::Registered);
}

TEST_P(StoreConformance, WhoRegistersARenamedRobotUnderItsOldLabelRenamesNothing) {
  ASSERT_TRUE(store_->rename_robot(panda_.digest, "panda_old"));
  ASSERT_TRUE(store_->register_robot(corrected()));  // has the label meanwhile
  EXPECT_EQ(*store_->register_robot(panda_), RegisterStatus::Known);
  EXPECT_EQ(store_->find_robot(panda_.digest)->description.label, "panda_old");
}

TEST_P(StoreConformance, ARenamedRobotKeepsItsMeshSolids) {
  RobotRecord robot = test::make_robot("mesh", 3);
  robot.description.mesh_solids.solids = {{"hand", SphereShape{0.3}}};
  ASSERT_TRUE(store_->register_robot(robot));
  ASSERT_TRUE(store_->rename_robot(robot.digest, "mesh_2"));
  EXPECT_EQ(store_->find_robot(robot.digest)->description.mesh_solids.solids.size(), 1U);
}

TEST_P(StoreConformance, ALabelOfAnotherRobotOrNoLabelIsRefused) {
  const Result<bool> taken = store_->rename_robot(panda_.digest, "iiwa");
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::Conflict);
  EXPECT_NE(taken.error().message.find("'iiwa'"), std::string::npos);
  EXPECT_EQ(store_->rename_robot(panda_.digest, "my robot").error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(store_->rename_robot(test::id_from<Digest>(9), "new").error().code,
            ErrorCode::NotFound);
  EXPECT_TRUE(store_->rename_robot(panda_.digest, "panda"));  // as it is called
  EXPECT_EQ(store_->find_robot(panda_.digest)->description.label, "panda");
}

TEST_P(StoreConformance, ARefusedLabelSaysHowToFreeIt) {
  const std::string message = store_->register_robot(corrected()).error().message;
  EXPECT_NE(message.find("kinship robots rename panda NEW"), std::string::npos) << message;
  EXPECT_NE(message.find("kinship robots remove panda"), std::string::npos) << message;
}

TEST_P(StoreConformance, AttemptsAreListedOnBehindThoseOfARemovedRobot) {
  for (std::uint64_t i = 1; i <= 3; ++i)
    report(solved(i));
  report(test::make_attempt(iiwa_.digest, "shelf", 4));
  ASSERT_TRUE(store_->remove_robot(panda_.digest));
  const Page<AttemptSummary> first = store_->list_attempts({}, "", "", 1);
  ASSERT_EQ(first.rows.size(), 1U);
  EXPECT_EQ(first.rows[0].report_uuid, test::id_from<Uuid>(4));
  report(test::make_attempt(iiwa_.digest, "shelf", 5));
  const Page<AttemptSummary> both = store_->list_attempts({}, "shelf", "", 1);
  ASSERT_EQ(both.rows.size(), 1U);
  ASSERT_FALSE(both.next_cursor.empty());
  EXPECT_EQ(store_->list_attempts({}, "shelf", both.next_cursor, 1).rows.at(0).report_uuid,
            test::id_from<Uuid>(5));
}

TEST_P(StoreConformance, ARobotWithoutAttemptsIsDeletedWithItsDistributions) {
  test::begin_task(*store_, iiwa_.digest, "shelf");
  const Distribution distribution = test::make_distribution(panda_.digest, "shelf", 5);
  EXPECT_EQ(store_->put_distribution(distribution), 1U);
  const RemovedRobot removed = store_->remove_robot(panda_.digest).value_or_throw();
  EXPECT_TRUE(removed.removal.is_deleted);
  EXPECT_EQ(removed.removal.label, "panda");
  EXPECT_EQ(removed.removal.distributions, 1U);
  EXPECT_EQ(removed.distributions, std::vector<Digest>{distribution.id});
  EXPECT_EQ(removed.tasks, std::vector<std::string>{"shelf"});
  reopen();
  EXPECT_FALSE(store_->find_robot(panda_.digest));
  EXPECT_FALSE(store_->find_distribution(distribution.id));
  EXPECT_EQ(store_->status().robots, 1U);
  EXPECT_EQ(*store_->register_robot(corrected()), RegisterStatus::Registered);
  EXPECT_THROW(static_cast<void>(store_->put_distribution(distribution)), Failure);
}

TEST_P(StoreConformance, OfARemovedRobotNothingIsReadAndEverythingIsKept) {
  report(solved(1));
  report(test::make_unsolved(panda_.digest, "table", 2));
  report(test::make_attempt(iiwa_.digest, "shelf", 3));
  const Distribution distribution = test::make_distribution(panda_.digest, "shelf", 5);
  store_->put_distribution(distribution);
  const RemovedRobot removed = store_->remove_robot(panda_.digest).value_or_throw();
  EXPECT_FALSE(removed.removal.is_deleted);
  EXPECT_EQ(removed.removal.paths, 1U);
  EXPECT_EQ(removed.removal.attempts, 2U);
  EXPECT_EQ(removed.tasks, (std::vector<std::string>{"shelf", "table"}));
  reopen();
  EXPECT_FALSE(store_->find_robot(panda_.digest));
  EXPECT_FALSE(store_->find_distribution(distribution.id));
  EXPECT_TRUE(store_->read_paths(panda_.digest, "shelf", kEveryPath).empty());
  EXPECT_EQ(store_->robots().size(), 1U);
  EXPECT_EQ(store_->list_robots("", 10).rows.size(), 1U);
  EXPECT_EQ(store_->status().robots, 1U);
  EXPECT_EQ(store_->find_task("shelf")->robots.size(), 1U);
  const std::vector<Attempt> exported = store_->export_attempts({}, "", "", 10, 1 << 20).rows;
  ASSERT_EQ(exported.size(), 1U);  // an unsolved one too would name a robot that is not exported
  EXPECT_EQ(exported[0].robot, iiwa_.digest);
  // For the record:
  EXPECT_EQ(store_->status().attempts, 3U);
  EXPECT_EQ(store_->find_attempt(solved(1).report_uuid)->robot, panda_.digest);
  EXPECT_EQ(store_->list_paths({}, "", "", 10).rows.size(), 2U);
  EXPECT_EQ(store_->remove_robot(panda_.digest).error().code, ErrorCode::NotFound);
}

TEST_P(StoreConformance, WhatARemovedRobotsPathsWereFittedIntoIsSeen) {
  report(solved(1));
  ASSERT_TRUE(store_->remove_robot(panda_.digest));
  const std::vector<ExperienceSummary> all = store_->experience("shelf");
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].robot, panda_.digest);
  EXPECT_EQ(all[0].paths, 0U);
  EXPECT_EQ(all[0].retired_generation, all[0].generation);
  EXPECT_GT(all[0].retired_generation, 0U);
}

TEST_P(StoreConformance, AReportOfARemovedRobotAsksForItsRegistrationAndThenCounts) {
  report(solved(1));
  ASSERT_TRUE(store_->remove_robot(panda_.digest));
  EXPECT_EQ(report(solved(2)), ReceiptStatus::UnknownRobot);
  RobotRecord again = panda_;
  again.description.label = "panda_2";
  EXPECT_EQ(*store_->register_robot(again), RegisterStatus::Registered);
  EXPECT_EQ(report(solved(1)), ReceiptStatus::Duplicate);  // stays retired
  EXPECT_EQ(report(solved(2)), ReceiptStatus::Stored);
  Attempt anew = solved(3);
  anew.path = solved(1).path;
  EXPECT_EQ(report(anew), ReceiptStatus::Stored);
  Attempt other = solved(1);
  other.record.collision_checks += 1;
  EXPECT_EQ(report(other), ReceiptStatus::Refused);
  EXPECT_EQ(store_->read_paths(panda_.digest, "shelf", kEveryPath).size(), 2U);
  const RobotRecord back = store_->find_robot(panda_.digest).value();
  EXPECT_EQ(back.description.label, "panda_2");
  EXPECT_GT(back.geometry_revision, 0U);  // a fit that was under way is none of its own
}

TEST_P(StoreConformance, ARemovalOfManyPathsMissesNone) {
  constexpr std::uint64_t kPaths = 1100;
  std::vector<Attempt> attempts;
  for (std::uint64_t i = 0; i < kPaths; ++i)
    attempts.push_back(solved(i));
  test::report(*store_, std::move(attempts));
  EXPECT_EQ(store_->remove_robot(panda_.digest)->removal.paths, kPaths);
  EXPECT_EQ(store_->status().paths, 0U);
}

TEST_P(StoreConformance, ARemovalThatIsStoppedLeavesTheRobotThere) {
  std::vector<Attempt> attempts;
  for (std::uint64_t i = 0; i < 600; ++i)
    attempts.push_back(solved(i));
  test::report(*store_, std::move(attempts));
  std::stop_source stop;
  stop.request_stop();
  const Result<RemovedRobot> stopped = store_->remove_robot(panda_.digest, stop.get_token());
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::Unavailable);
  EXPECT_TRUE(store_->find_robot(panda_.digest));
  EXPECT_TRUE(store_->remove_robot(panda_.digest));
}

TEST_P(StoreConformance, AGoneRobotsFitIsNotStored) {
  report(solved(1));
  ASSERT_TRUE(store_->remove_robot(panda_.digest));
  try {
    store_->put_distribution(test::make_distribution(panda_.digest, "shelf", 5));
    FAIL() << "it was stored";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
  }
}

}  // namespace
}  // namespace kinship::store
