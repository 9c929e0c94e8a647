#include "proto/types/limits.hpp"
#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

TEST_P(StoreConformance, KnowsARobotByItsDigest) {
  RobotRecord renamed = panda_;
  renamed.description.label = "another";
  EXPECT_EQ(*store_->register_robot(renamed), RegisterStatus::Known);
  EXPECT_EQ(store_->find_robot(panda_.digest)->description.label, "panda");
  EXPECT_EQ(store_->robots().size(), 2U);
}

TEST_P(StoreConformance, RefusesALabelThatAnotherRobotHas) {
  const Result<RegisterStatus> second = store_->register_robot(test::make_robot("panda", 3));
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::Conflict);
  EXPECT_NE(second.error().message.find("'panda'"), std::string::npos);
}

TEST_P(StoreConformance, GivesARobotBackAsItWas) {
  const std::optional<RobotRecord> after = store_->find_robot(panda_.digest);
  ASSERT_TRUE(after);
  const RobotDescription& was = panda_.description;
  const RobotDescription& is = after->description;
  EXPECT_EQ(after->digest, panda_.digest);
  EXPECT_EQ(after->dof, panda_.dof);
  EXPECT_EQ(after->registered_ms, panda_.registered_ms);
  EXPECT_EQ(is.label, was.label);
  EXPECT_EQ(is.urdf, was.urdf);
  EXPECT_EQ(is.base_link, was.base_link);
  EXPECT_EQ(is.tip_link, was.tip_link);
  EXPECT_TRUE(is.T_tip_transfer.isApprox(was.T_tip_transfer, 1e-15));
  EXPECT_EQ(is.task_axes, was.task_axes);
  EXPECT_EQ(is.held_joints, was.held_joints);
  EXPECT_EQ(is.never_colliding, was.never_colliding);
  EXPECT_FALSE(store_->find_robot(test::id_from<Digest>(9)));
}

RobotRecord with_solids(RobotRecord robot) {
  robot.description.mesh_solids.solids = {{"arm", CapsuleShape{0.1, 0.2}, test::make_pose()},
                                          {"hand", SphereShape{0.3}}};
  robot.description.mesh_solids.unfiltered = {{"arm", "hand"}};
  return robot;
}

TEST_P(StoreConformance, GivesMeshSolidsBackAsTheyWere) {
  const RobotRecord robot = with_solids(test::make_robot("mesh", 3));
  ASSERT_EQ(store_->register_robot(robot).value_or_throw(), RegisterStatus::Registered);
  reopen();
  const RobotRecord after = store_->find_robot(robot.digest).value();
  const MeshSolids &is = after.description.mesh_solids, &was = robot.description.mesh_solids;
  ASSERT_EQ(is.solids.size(), 2U);
  EXPECT_EQ(std::get<CapsuleShape>(is.solids[0].shape).length_m, 0.2);
  EXPECT_TRUE(is.solids[0].T_link_shape.isApprox(was.solids[0].T_link_shape, 1e-15));
  EXPECT_EQ(is.solids[1].link, "hand");
  EXPECT_EQ(is.unfiltered, was.unfiltered);
  EXPECT_EQ(after.geometry_revision, 0U);
  EXPECT_TRUE(store_->geometry_revisions().empty());
}

TEST_P(StoreConformance, TakesBetterGeometryOfAKnownRobotOnce) {
  RobotRecord better = with_solids(panda_);
  better.description.label = "another";
  better.description.urdf += "<!-- better -->";
  better.registered_ms = better.geometry_ms = panda_.registered_ms + 5;
  better.geometry_revision = 1;
  EXPECT_TRUE(store_->replace_geometry(better));
  EXPECT_FALSE(store_->replace_geometry(better)) << "somebody was first";
  reopen();
  const RobotRecord after = store_->find_robot(panda_.digest).value();
  EXPECT_EQ(after.description.label, "panda");
  EXPECT_EQ(after.registered_ms, panda_.registered_ms);
  EXPECT_EQ(after.description.urdf, better.description.urdf);
  EXPECT_EQ(after.description.mesh_solids.solids.size(), 2U);
  EXPECT_EQ(after.geometry_revision, 1U);
  EXPECT_EQ(after.geometry_ms, better.geometry_ms);
  EXPECT_EQ(store_->geometry_revisions(), (std::map<Digest, std::uint64_t>{{panda_.digest, 1}}));
  for (const RobotSummary& row : store_->list_robots("", 10).rows)
    EXPECT_EQ(row.geometry_ms, row.robot == panda_.digest ? better.geometry_ms : 0);
  RobotRecord exact = panda_;
  exact.geometry_revision = 2;
  EXPECT_TRUE(store_->replace_geometry(exact));
  EXPECT_TRUE(store_->find_robot(panda_.digest)->description.mesh_solids.solids.empty());
  EXPECT_EQ(store_->geometry_revisions().at(panda_.digest), 2U);
  EXPECT_EQ(*store_->register_robot(better), RegisterStatus::Known);
  RobotRecord nobody = test::make_robot("nobody", 9);
  nobody.geometry_revision = 1;
  EXPECT_FALSE(store_->replace_geometry(nobody));
}

TEST_P(StoreConformance, ASceneKeepsWhatOfItIsApproximate) {
  Attempt attempt = solved(60);
  attempt.scene = RecordedScene{{{"rock", BoxShape{{1, 2, 3}}}, {"table", BoxShape{{2, 2, 1}}}},
                                {{"can", SphereShape{0.1}}},
                                {}};
  attempt.scene->objects[0].approximate = attempt.scene->held[0].approximate = true;
  Attempt exact = solved(61);
  exact.scene = attempt.scene;
  exact.scene->objects[0].approximate = exact.scene->held[0].approximate = false;
  EXPECT_EQ(report(attempt), ReceiptStatus::Stored);
  EXPECT_EQ(report(exact), ReceiptStatus::Stored);
  const RecordedScene after = store_->find_attempt(attempt.report_uuid)->scene.value();
  EXPECT_TRUE(after.objects[0].approximate);
  EXPECT_FALSE(after.objects[1].approximate);
  EXPECT_TRUE(after.held[0].approximate);
  EXPECT_FALSE(store_->find_attempt(exact.report_uuid)->scene->objects[0].approximate);
}

TEST_P(StoreConformance, NamesTheRobotsWithPathsOfATask) {
  report(solved(1));
  report(test::make_unsolved(iiwa_.digest, "shelf", 2));
  const std::vector<ExperienceSummary> experience = store_->experience("shelf");
  ASSERT_EQ(experience.size(), 1U);
  EXPECT_EQ(experience[0].robot, panda_.digest);
  EXPECT_EQ(experience[0].paths, 1U);
  EXPECT_EQ(experience[0].generation, 1U);
  EXPECT_TRUE(store_->experience("table").empty());
}

TEST_P(StoreConformance, NamesTasksOfSomeLengths) {
  std::uint64_t number = 0;
  for (const char* const task : {"lod", "load", "loader", "bin", "unload"})
    report(test::make_attempt(panda_.digest, task, ++number));
  report(test::make_unsolved(panda_.digest, "bind", ++number));
  ASSERT_TRUE(store_->remove_task("bin"));
  using Names = std::vector<std::string>;
  const auto names = [this](std::size_t letters, bool with_paths, std::size_t limit) {
    return store_->task_names(
        {.like = "lods", .letters = letters, .with_paths = with_paths, .limit = limit});
  };
  EXPECT_EQ(names(0, false, 9), (Names{"bind", "load"}));
  EXPECT_EQ(names(1, false, 9), (Names{"bind", "load", "lod"}));
  EXPECT_EQ(names(1, true, 9), (Names{"load", "lod"}));
  EXPECT_EQ(names(2, true, 9), (Names{"load", "loader", "lod", "unload"}));
  EXPECT_EQ(names(2, false, 2), (Names{"bind", "load"}));
}

TEST_P(StoreConformance, TheStatusCountsTheTasksThatAreListed) {
  report(test::make_attempt(panda_.digest, "shelf", 1));
  report(test::make_unsolved(panda_.digest, "table", 2));
  EXPECT_EQ(store_->status().tasks, 2U);
  ASSERT_TRUE(store_->remove_task("shelf"));
  EXPECT_EQ(store_->list_tasks("", 10).rows.size(), 1U);
  EXPECT_EQ(store_->status().tasks, 1U);
  report(test::make_attempt(panda_.digest, "shelf", 3));
  EXPECT_EQ(store_->status().tasks, 2U) << "an attempt came since";
}

TEST_P(StoreConformance, CountsTheRevisionsOfADistribution) {
  test::begin_task(*store_, panda_.digest, "shelf");
  Distribution distribution = test::make_distribution(panda_.digest, "shelf", 1);
  EXPECT_EQ(store_->put_distribution(distribution), 1U);
  EXPECT_EQ(store_->put_distribution(distribution), 2U);
  EXPECT_EQ(store_->put_distribution(test::make_distribution(panda_.digest, "shelf", 2)), 1U);
  reopen();
  EXPECT_EQ(store_->put_distribution(distribution), 3U);
  EXPECT_EQ(store_->status().distributions, 2U);
}

TEST_P(StoreConformance, GivesTheNewestRevisionBack) {
  test::begin_task(*store_, panda_.digest, "shelf");
  Distribution distribution = test::make_distribution(panda_.digest, "shelf", 1);
  store_->put_distribution(distribution);
  distribution.state = DistributionState::Failed;
  distribution.reason = "out of reach";
  distribution.mixture.reset();
  store_->put_distribution(distribution);
  const std::optional<Distribution> found = store_->find_distribution(distribution.id);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->revision, 2U);
  EXPECT_EQ(found->store_epoch, store_->epoch());
  EXPECT_EQ(found->state, DistributionState::Failed);
  EXPECT_EQ(found->reason, "out of reach");
  EXPECT_EQ(found->sources.size(), 1U);
  EXPECT_FALSE(store_->find_distribution(test::id_from<Digest>(5)));
}

TEST_P(StoreConformance, ADistributionNeedsItsRobot) {
  try {
    store_->put_distribution(test::make_distribution(test::id_from<Digest>(7), "shelf", 1));
    FAIL() << "stored for a robot that is not there";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
  }
}

TEST_P(StoreConformance, ADistributionNeedsItsTask) {
  const Distribution distribution = test::make_distribution(panda_.digest, "shelf", 1);
  const auto is_refused = [&] {
    try {
      store_->put_distribution(distribution);
      return false;
    } catch (const Failure& failure) {
      return failure.code() == ErrorCode::NotFound;
    }
  };
  EXPECT_TRUE(is_refused());
  EXPECT_EQ(store_->status().tasks, 0U);
  report(solved(1));
  EXPECT_EQ(store_->put_distribution(distribution), 1U);
  ASSERT_TRUE(store_->rename_task("shelf", "rack"));  // during the next fit
  EXPECT_TRUE(is_refused());
  EXPECT_FALSE(store_->find_task("shelf"));
  report(solved(2));
  ASSERT_TRUE(store_->remove_task("shelf"));
  EXPECT_TRUE(is_refused());
  EXPECT_TRUE(store_->list_distributions({}, "", "", 10).rows.empty());
}

TEST_P(StoreConformance, TakesNoDistributionOrRobotThatItCouldNotGiveBack) {
  test::begin_task(*store_, panda_.digest, "shelf");
  Distribution distribution = test::make_distribution(panda_.digest, "shelf", 1);
  distribution.sources.resize(kMaxSources + 1, distribution.sources[0]);
  EXPECT_THROW(store_->put_distribution(distribution), Failure);
  EXPECT_EQ(store_->status().distributions, 0U);
  RobotRecord robot = test::make_robot("far", 3);
  robot.description.T_tip_transfer.translation().x() = 1e6;
  EXPECT_EQ(store_->register_robot(robot).error().code, ErrorCode::InvalidInput);
  EXPECT_FALSE(store_->find_robot(robot.digest));
}

TEST_P(StoreConformance, ReopenKeepsEverything) {
  report(solved(1));
  report(test::make_unsolved(iiwa_.digest, "table", 2));
  const Distribution distribution = test::make_distribution(iiwa_.digest, "shelf", 3);
  store_->put_distribution(distribution);
  const StoreStatus before = store_->status();
  reopen();
  const StoreStatus after = store_->status();
  EXPECT_EQ(after.epoch, before.epoch);
  EXPECT_EQ(after.robots, 2U);
  EXPECT_EQ(after.tasks, 2U);
  EXPECT_EQ(after.attempts, 2U);
  EXPECT_EQ(after.paths, 1U);
  EXPECT_EQ(after.distributions, 1U);
  EXPECT_TRUE(after.writable);
  EXPECT_EQ(store_->generation(panda_.digest, "shelf"), 1U);
  EXPECT_EQ(store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 10}).size(), 1U);
  EXPECT_EQ(store_->find_distribution(distribution.id)->mixture->means(),
            distribution.mixture->means());
  EXPECT_EQ(report(solved(1)), ReceiptStatus::Duplicate);
}

/// Reads a listing to its end, page by page.
template <typename Row, typename List>
std::vector<Row> all_pages(List list) {
  std::vector<Row> rows;
  std::string cursor;
  do {
    Page<Row> page = list(cursor);
    EXPECT_LE(page.rows.size(), 2U);
    for (Row& row : page.rows)
      rows.push_back(std::move(row));
    cursor = page.next_cursor;
  } while (!cursor.empty());
  return rows;
}

TEST_P(StoreConformance, ListsRobotsByLabelPageByPage) {
  for (std::uint64_t i = 3; i < 7; ++i)
    ASSERT_TRUE(store_->register_robot(test::make_robot("robot" + std::to_string(i), i)));
  report(solved(1));
  report(test::make_unsolved(panda_.digest, "table", 2));
  const auto robots = all_pages<RobotSummary>(
      [this](const std::string& cursor) { return store_->list_robots(cursor, 2); });
  ASSERT_EQ(robots.size(), 6U);
  for (std::size_t i = 1; i < robots.size(); ++i)
    EXPECT_LT(robots[i - 1].label, robots[i].label);
  EXPECT_EQ(robots[1].label, "panda");
  EXPECT_EQ(robots[1].dof, test::kDof);
  EXPECT_EQ(robots[1].paths, 1U);
  EXPECT_EQ(robots[1].attempts, 2U);
}

TEST_P(StoreConformance, ListsTasksWithTheirRobots) {
  report(solved(1));
  report(test::make_unsolved(iiwa_.digest, "shelf", 2));
  report(test::make_unsolved(iiwa_.digest, "bin", 3));
  report(test::make_unsolved(iiwa_.digest, "table", 4));
  const auto tasks = all_pages<TaskSummary>(
      [this](const std::string& cursor) { return store_->list_tasks(cursor, 2); });
  ASSERT_EQ(tasks.size(), 3U);
  EXPECT_EQ(tasks[1].task, "shelf");
  EXPECT_EQ(tasks[1].paths, 1U);
  EXPECT_EQ(tasks[1].attempts, 2U);
  ASSERT_EQ(tasks[1].robots.size(), 2U);
  EXPECT_EQ(tasks[1].robots[1].label, "panda");
  EXPECT_EQ(tasks[1].robots[1].generation, 1U);
  EXPECT_EQ(store_->find_task("shelf")->attempts, 2U);
  EXPECT_FALSE(store_->find_task("nothing"));
}

TEST_P(StoreConformance, ListsPathsOnceEachUnderEveryFilter) {
  std::uint64_t number = 0;
  for (const RobotRecord* robot : {&panda_, &iiwa_})
    for (const char* const task : {"shelf", "table"})
      for (int i = 0; i < 3; ++i)
        report(test::make_attempt(robot->digest, task, ++number));
  const auto list = [this](const std::optional<Digest>& robot, const char* task) {
    return all_pages<PathSummary>(
        [&](const std::string& cursor) { return store_->list_paths(robot, task, cursor, 2); });
  };
  EXPECT_EQ(list(std::nullopt, "").size(), 12U);
  EXPECT_EQ(list(panda_.digest, "").size(), 6U);
  EXPECT_EQ(list(std::nullopt, "table").size(), 6U);
  const auto paths = list(iiwa_.digest, "table");
  ASSERT_EQ(paths.size(), 3U);
  EXPECT_EQ(paths[0].report_uuid, test::id_from<Uuid>(12)) << "the newest first";
  EXPECT_EQ(paths[0].label, "iiwa");
  EXPECT_EQ(paths[0].task, "table");
  EXPECT_EQ(paths[0].machine, "cell 7");
  EXPECT_EQ(paths[0].waypoints, 20U);
  EXPECT_GT(paths[0].length, 0);
  EXPECT_GT(paths[0].received_ms, 0);
  EXPECT_EQ(paths[0].record.collision_checks, 1234U);
  EXPECT_TRUE(paths[0].T_task_base->isApprox(test::make_pose(), 1e-15));
}

TEST_P(StoreConformance, ListsAttemptsByArrivalUnderEveryFilter) {
  std::uint64_t number = 0;
  for (int i = 0; i < 3; ++i)
    for (const RobotRecord* robot : {&panda_, &iiwa_})
      for (const char* const task : {"shelf", "table"})
        report(i == 1 ? test::make_unsolved(robot->digest, task, ++number)
                      : test::make_attempt(robot->digest, task, ++number));
  static_cast<void>(store_->retire_path(test::id_from<Uuid>(1)));
  const auto list = [this](const std::optional<Digest>& robot, const char* task) {
    return all_pages<AttemptSummary>(
        [&](const std::string& cursor) { return store_->list_attempts(robot, task, cursor, 2); });
  };
  const auto all = list(std::nullopt, "");
  ASSERT_EQ(all.size(), 12U) << "also unsolved ones and those of retired paths";
  for (std::uint64_t i = 0; i < 12; ++i)
    EXPECT_EQ(all[i].report_uuid, test::id_from<Uuid>(i + 1));
  EXPECT_EQ(list(panda_.digest, "").size(), 6U);
  EXPECT_EQ(list(std::nullopt, "table").size(), 6U);
  const auto attempts = list(iiwa_.digest, "table");
  ASSERT_EQ(attempts.size(), 3U);
  EXPECT_EQ(attempts[0].label, "iiwa");
  EXPECT_EQ(attempts[0].robot, iiwa_.digest);
  EXPECT_EQ(attempts[0].task, "table");
  EXPECT_EQ(attempts[0].machine, "cell 7");
  EXPECT_EQ(attempts[0].record.outcome, Outcome::Solved);
  EXPECT_EQ(attempts[0].record.collision_checks, 1234U);
  EXPECT_NE(attempts[1].record.outcome, Outcome::Solved);
  EXPECT_GT(attempts[0].received_ms, 0);
  EXPECT_THROW(store_->list_attempts({}, "", "1.2", 2), Failure);
}

TEST_P(StoreConformance, ListsTheNewestFirstAndNothingTwiceWhileMoreComes) {
  std::uint64_t number = 0;
  for (int i = 0; i < 4; ++i)  // in turns, so that robots and tasks are mixed
    for (const RobotRecord* robot : {&panda_, &iiwa_})
      report(test::make_attempt(robot->digest, i % 2 == 0 ? "shelf" : "table", ++number));
  for (const auto& robot : {std::optional<Digest>(), std::optional(panda_.digest)}) {
    std::vector<Uuid> listed;
    std::string cursor;
    do {
      const Page<PathSummary> page = store_->list_paths(robot, "", cursor, 3);
      for (const PathSummary& path : page.rows)
        listed.push_back(path.report_uuid);
      cursor = page.next_cursor;
      if (!robot)
        report(test::make_attempt(panda_.digest, "bin", ++number + 100));  // not seen any more
    } while (!cursor.empty());
    ASSERT_EQ(listed.size(), robot ? 7U : 8U);  // three came to the bin meanwhile
    for (std::uint64_t i = 0; i < (robot ? 4U : 8U); ++i)
      EXPECT_EQ(listed[listed.size() - 1 - i], test::id_from<Uuid>(robot ? 2 * i + 1 : i + 1)) << i;
  }
  for (std::uint64_t i = 1; i <= 3; ++i)
    store_->put_distribution(test::make_distribution(panda_.digest, "shelf", i));
  store_->put_distribution(test::make_distribution(panda_.digest, "shelf", 2));  // fitted again
  const std::vector<DistributionSummary> fits = store_->list_distributions({}, "", "", 9).rows;
  ASSERT_EQ(fits.size(), 3U);
  EXPECT_EQ(fits[0].id, test::id_from<Digest>(2));
  EXPECT_EQ(fits[0].revision, 2U);
  EXPECT_EQ(fits[2].id, test::id_from<Digest>(1));
}

TEST_P(StoreConformance, ListsDistributionsUnderEveryFilter) {
  report(test::make_unsolved(panda_.digest, "shelf", 1));
  report(test::make_unsolved(panda_.digest, "table", 2));
  for (std::uint64_t i = 1; i <= 3; ++i)
    store_->put_distribution(test::make_distribution(panda_.digest, "shelf", i));
  store_->put_distribution(test::make_distribution(iiwa_.digest, "table", 4));
  const auto list = [this](const std::optional<Digest>& robot, const char* task) {
    return all_pages<DistributionSummary>([&](const std::string& cursor) {
      return store_->list_distributions(robot, task, cursor, 2);
    });
  };
  EXPECT_EQ(list(std::nullopt, "").size(), 4U);
  EXPECT_EQ(list(panda_.digest, "").size(), 3U);
  EXPECT_TRUE(list(panda_.digest, "table").empty());
  const auto found = list(std::nullopt, "table");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].label, "iiwa");
  EXPECT_EQ(found[0].revision, 1U);
  EXPECT_EQ(found[0].components, 2U);
  EXPECT_EQ(found[0].configurations, 3000U);
  EXPECT_EQ(found[0].paths, 12U);
  EXPECT_EQ(found[0].reason, "2 of 5 poses out of reach");
}

TEST_P(StoreConformance, RefusesACursorOfSomethingElse) {
  for (const char* const cursor : {"x", "1.2", "1.2.3", "-1", "1 ", "99999999999999999999"})
    EXPECT_THROW(store_->list_paths({}, "", cursor, 2), Failure) << cursor;
  EXPECT_THROW(store_->list_distributions({}, "", "1a", 2), Failure);
}

}  // namespace
}  // namespace kinship::store
