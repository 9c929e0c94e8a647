#include "tests/golden/golden_store.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::golden_store_test {
namespace {

constexpr std::uint64_t kAttempts = 17;
constexpr std::uint64_t kPaths = 11;
constexpr int kFirstWithRehearsals = 2, kFirstWithSearches = 3, kFirstWithMeshes = 4,
              kFirstWithRemovedTasks = 5;

/// A copy of tests/golden/store-N.db, opened by today's code.
class GoldenStore : public testing::TestWithParam<int> {
 protected:
  GoldenStore() {
    const std::string name = "store-" + std::to_string(GetParam()) + ".db";
    std::filesystem::copy_file(std::filesystem::path(test::source_dir() + "/tests/golden") / name,
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
  EXPECT_EQ(store_->status().attempts, kAttempts);
  EXPECT_EQ(store_->status().paths, kPaths);
  EXPECT_EQ(store_->generation(test::golden_robots()[0].digest, "bin"), 1U);
}

TEST_P(GoldenStore, StillHasItsDistribution) {
  const Distribution wanted = test::golden_distribution();
  const std::optional<Distribution> found = store_->find_distribution(wanted.id);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->revision, 2U);
  EXPECT_EQ(found->selection, wanted.selection);
  EXPECT_EQ(found->sources[0].relation, Relation::Other);
  EXPECT_EQ(found->sources[0].paths_used, 0U);
  EXPECT_EQ(found->mixture->means(), wanted.mixture->means());
  EXPECT_EQ(found->mixture->covariances(), wanted.mixture->covariances());
}

TEST_P(GoldenStore, StillHasItsRehearsal) {
  const store::StoredRehearsal wanted = test::golden_rehearsal();
  std::vector<store::StoredRehearsal> found = store_->read_rehearsals(10);
  if (GetParam() < kFirstWithRehearsals) {
    EXPECT_TRUE(found.empty());
    store_->put_rehearsal(wanted);
    found = store_->read_rehearsals(10);
  }
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, wanted.id);
  EXPECT_EQ(found[0].rehearsal, wanted.rehearsal);
  ASSERT_TRUE(found[0].library);
  EXPECT_EQ(found[0].library->paths[0].waypoints, wanted.library->paths[0].waypoints);
}

TEST_P(GoldenStore, StillHasItsSearchRecord) {
  Attempt fresh = test::golden_attempts()[4];
  const std::optional<SearchRecord> found = store_->find_attempt(fresh.report_uuid)->search;
  ASSERT_EQ(found.has_value(), GetParam() >= kFirstWithSearches);
  if (found) {
    EXPECT_EQ(found->goals, fresh.search->goals);
    EXPECT_EQ(why_text(*found), why_text(*fresh.search));
  }
  EXPECT_EQ(test::report(*store_, {fresh})[0].status, ReceiptStatus::Duplicate);
  fresh.report_uuid = test::id_from<Uuid>(1002);
  EXPECT_EQ(test::report(*store_, {fresh})[0].status, ReceiptStatus::Recorded);
  EXPECT_EQ(store_->find_attempt(fresh.report_uuid)->search->goals, fresh.search->goals);
}

TEST_P(GoldenStore, KnowsWhenItsPathsArrivedAndWhatItsArmsCost) {
  const Digest robot = test::golden_robots()[0].digest;
  const std::vector<PathSummary> listed = store_->list_paths(robot, "shelf", "", 10).rows;
  const auto paths = store_->read_paths(robot, "shelf", {.after_id = 0, .limit = 10});
  ASSERT_EQ(paths.size(), 2U);
  ASSERT_EQ(listed.size(), 2U);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    EXPECT_GT(paths[i].received_ms, 1'790'000'000'000);
    EXPECT_EQ(paths[i].received_ms, listed[1 - i].received_ms) << "the newest is listed first";
    EXPECT_EQ(listed[i].retired_ms, 0);
  }
  const store::AttemptTotals totals = store_->attempt_totals(robot, "shelf");
  EXPECT_EQ(totals.control.attempts, 3U);
  EXPECT_EQ(totals.control.solved, 2U);
  EXPECT_EQ(totals.control.checks, 3 * 1234);
  EXPECT_EQ(totals.control.checks_squared, 3 * 1234 * 1234);
  EXPECT_EQ(totals.control.checks_of_solved, 2 * 1234);
  EXPECT_EQ(totals.guided.attempts, 0U);
  ASSERT_EQ(totals.recent.size(), 3U);
  EXPECT_EQ(totals.recent[0].judged.time_s, 0) << "unknown in a schema that lacks it";
  EXPECT_EQ(store_->experience("shelf")[0].retired_generation, 0U);
}

TEST_P(GoldenStore, RetiresExportsAndEvictsWhatItHad) {
  const std::size_t with_scene = 2, capped = test::kGoldenCap;
  EXPECT_EQ(store_->export_attempts({}, "", "", 100, 1'000'000).rows.size(),
            8U + with_scene + capped);
  const Attempt bad = test::golden_attempts()[6];
  EXPECT_EQ(store_->retire_path(bad.report_uuid)->paths, 1U);
  EXPECT_EQ(store_->reset_task("shelf")->paths, 5U);
  EXPECT_EQ(store_->status().paths, 1U + with_scene + capped);
  EXPECT_EQ(store_->export_attempts({}, "", "", 100, 1'000'000).rows.size(),
            2U + with_scene + capped);
  const Distribution distribution = test::golden_distribution();
  EXPECT_TRUE(store_->evict_distribution(distribution.id));
  EXPECT_EQ(store_->put_distribution(distribution), 3U);
}

TEST_P(GoldenStore, StillKnowsWhatWasRetiredAndEvicted) {
  const Attempt retired = test::golden_retired_attempt();
  const std::vector<PathSummary> listed = store_->list_paths({}, "drawer", "", 10).rows;
  ASSERT_EQ(listed.size(), 1U);
  EXPECT_GE(listed[0].retired_ms, listed[0].received_ms);
  const store::ExperienceSummary experience = store_->experience("drawer").at(0);
  EXPECT_EQ(experience.paths, 0U);
  EXPECT_EQ(experience.retired_generation, 2U);
  EXPECT_EQ(test::report(*store_, {retired})[0].status, ReceiptStatus::Duplicate);
  EXPECT_EQ(store_->put_distribution(test::golden_evicted_distribution()), 2U);
}

TEST_P(GoldenStore, StillKnowsWhichTaskWasRemoved) {
  Attempt next = test::golden_retired_attempt();
  EXPECT_EQ(store_->find_task(next.task).has_value(), GetParam() < kFirstWithRemovedTasks);
  next.report_uuid = test::id_from<Uuid>(1003);
  EXPECT_EQ(test::report(*store_, {next})[0].status, ReceiptStatus::Stored);
  EXPECT_EQ(store_->find_task(next.task)->attempts, 3U);
}

TEST_P(GoldenStore, StillHasItsScenesOnce) {
  const auto paths =
      store_->read_paths(test::golden_robots()[1].digest, "table", {.after_id = 0, .limit = 9});
  ASSERT_EQ(paths.size(), 2U);
  ASSERT_TRUE(paths[0].scene_id);
  EXPECT_EQ(paths[1].scene_id, paths[0].scene_id);
  const Attempt wanted = test::golden_attempts_with_scene()[0];
  const std::optional<RecordedScene> scene = store_->read_scene(*paths[0].scene_id);
  ASSERT_TRUE(scene);
  EXPECT_EQ(content_digest(*scene), content_digest(*wanted.scene));
  EXPECT_EQ(test::report(*store_, {wanted})[0].status, ReceiptStatus::Duplicate);
}

TEST_P(GoldenStore, StillKnowsWhatWasBeyondItsCap) {
  const std::vector<Attempt> attempts = test::golden_capped_attempts();
  EXPECT_EQ(store_->read_paths(test::golden_robots()[0].digest, "tray", {.after_id = 0, .limit = 9})
                .size(),
            test::kGoldenCap);
  EXPECT_EQ(store_->status().dropped_paths, attempts.size() - test::kGoldenCap);
  for (const Receipt& receipt : test::report(*store_, attempts))
    EXPECT_EQ(receipt.status, ReceiptStatus::Duplicate) << receipt.message;
}

TEST_P(GoldenStore, StillKnowsTheSolidsAroundItsMeshes) {
  const auto robot = store_->find_robot(test::golden_robots()[0].digest);
  ASSERT_TRUE(robot);
  EXPECT_EQ(robot->geometry_revision, 1U);
  const MeshSolids &found = robot->description.mesh_solids, wanted = test::golden_mesh_solids();
  ASSERT_EQ(found.solids.size(), wanted.solids.size());
  EXPECT_EQ(found.solids[0].link, "hand");
  EXPECT_EQ(std::get<BoxShape>(found.solids[0].shape).size,
            std::get<BoxShape>(wanted.solids[0].shape).size);
  EXPECT_EQ(found.unfiltered, wanted.unfiltered);
}

TEST_P(GoldenStore, StillHasItsMeshes) {
  const Digest robot = test::golden_robots()[0].digest, content = test::golden_mesh().digest();
  const std::vector<LinkMesh> wanted = test::golden_link_meshes(),
                              found = store_->find_robot(robot)->description.meshes;
  ASSERT_EQ(found.size(), GetParam() >= kFirstWithMeshes ? 1U : 0U);
  if (!found.empty()) {
    EXPECT_EQ(found[0].link, "hand");
    EXPECT_EQ(found[0].role, MeshRole::Visual);
    EXPECT_EQ(found[0].rgba, wanted[0].rgba);
    EXPECT_EQ(found[0].error_m, wanted[0].error_m);
    ASSERT_TRUE(store_->find_mesh(content));
    EXPECT_EQ(TriangleMesh::read(*store_->find_mesh(content))->digest(), content);
    return;
  }
  store::RobotRecord better = store_->find_robot(robot).value();
  better.description.meshes = wanted;
  ++better.geometry_revision;
  EXPECT_TRUE(store_->replace_geometry(better));
  EXPECT_EQ(store_->put_meshes(robot, {test::golden_mesh().content()}, {1U << 20U, 0}).stored, 1U);
}

TEST_P(GoldenStore, StillHasItsAuditLogAndTakesEntries) {
  const AuditEntry wanted = test::golden_audit_entry();
  const std::vector<AuditEntry> log = store_->list_audit("anna", "", 10).rows;
  ASSERT_EQ(log.size(), 3U);
  EXPECT_EQ(log[0].message, wanted.message);
  EXPECT_EQ(log[0].outcome, AuditOutcome::Refused);
  EXPECT_FALSE(log[0].is_local);
  EXPECT_EQ(log[1].after, "gone");
  EXPECT_EQ(log[2].before, "task 'drawer': 1 path");
  EXPECT_GT(log[2].time_ms, 1'790'000'000'000);
  store_->add_audit(wanted);
  EXPECT_EQ(store_->list_audit("", "", 10).rows.at(0).message, wanted.message);
}

TEST_P(GoldenStore, StillKnowsWhatIsToBeRetiredWhenItComes) {
  const std::vector<Uuid> listed = store_->list_retirements("", 10).rows;
  ASSERT_EQ(listed.size(), 3U);
  const Attempt later =
      test::make_attempt(test::golden_robots()[0].digest, "drawer", test::kGoldenRetiredBefore);
  const std::vector<store::ArrivedReport> drawer = store_->list_arrivals("drawer", "", 10).rows;
  for (const store::ArrivedReport& report : drawer)
    EXPECT_TRUE(report.is_retired);
  EXPECT_EQ(drawer.size(), 2U);
  EXPECT_EQ(test::report(*store_, {later})[0].status, ReceiptStatus::Recorded);
  EXPECT_EQ(store_->notes("golden").size(), 1U);
}

TEST_P(GoldenStore, TakesASceneWithItsReport) {
  Attempt fresh = test::make_attempt(test::golden_robots()[0].digest, "bin", 1001);
  fresh.scene = test::golden_attempts_with_scene()[0].scene;
  EXPECT_EQ(test::report(*store_, {fresh})[0].status, ReceiptStatus::Stored);
  EXPECT_TRUE(store_->find_attempt(fresh.report_uuid)->scene);
}

TEST_P(GoldenStore, TakesRetriesAndNewReports) {
  for (const Receipt& receipt : test::report(*store_, test::golden_attempts()))
    EXPECT_EQ(receipt.status, ReceiptStatus::Duplicate) << receipt.message;
  Attempt fresh = test::make_attempt(test::golden_robots()[0].digest, "bin", 1000);
  fresh.record.processor_time_s = fresh.record.machine_speed = 0.5;
  fresh.record.hand_length_m = 2;
  fresh.record.least_clearance_m = 0.03;
  EXPECT_EQ(test::report(*store_, {fresh})[0].status, ReceiptStatus::Stored);
  const std::vector<TaskRobotSummary> robots = store_->find_task("bin")->robots;
  const auto row = std::ranges::find(robots, fresh.robot, &TaskRobotSummary::robot);
  ASSERT_TRUE(row != robots.end() && row->control_means) << "measured from schema 5 on";
  EXPECT_EQ(row->control_means->attempts, 1U);
  EXPECT_EQ(row->control_means->hand_length_m, 2);
}

INSTANTIATE_TEST_SUITE_P(Schema, GoldenStore, testing::Values(1, 2, 3, 4, 5));

}  // namespace
}  // namespace kinship::golden_store_test
