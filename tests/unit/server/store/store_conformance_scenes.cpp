#include <limits>

#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

RecordedScene kitchen(double shelf_m = 1) {
  Eigen::Isometry3d T = test::make_pose();
  T.translation().z() = shelf_m;
  return {{{"table", BoxShape{{1, 2, 0.1}}}, {"shelf", CylinderShape{0.1, shelf_m}, T}},
          {{"can", SphereShape{0.05}, T}},
          {{"can", "table"}}};
}

Attempt with(Attempt attempt, const RecordedScene& scene) {
  attempt.scene = scene;
  return attempt;
}

TEST_P(StoreConformance, ASceneComesBackWithItsPathAndWithItsAttempt) {
  report(with(solved(1), kitchen()));
  report(solved(2));
  report(with(test::make_unsolved(panda_.digest, "shelf", 3), kitchen()));
  reopen();
  const auto paths = store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 10});
  ASSERT_EQ(paths.size(), 2U);
  ASSERT_TRUE(paths[0].scene_id);
  EXPECT_FALSE(paths[1].scene_id);
  const auto scene = store_->read_scene(*paths[0].scene_id);
  ASSERT_TRUE(scene);
  EXPECT_EQ(content_digest(*scene), content_digest(kitchen()));
  EXPECT_EQ(scene->objects[1].name, "shelf");
  EXPECT_EQ(std::get<CylinderShape>(scene->objects[1].shape).radius_m, 0.1);
  const auto unsolved = store_->find_attempt(test::id_from<Uuid>(3));
  ASSERT_TRUE(unsolved && unsolved->scene);
  EXPECT_EQ(content_digest(*unsolved->scene), content_digest(kitchen()));
  EXPECT_FALSE(store_->find_attempt(test::id_from<Uuid>(2))->scene);
  EXPECT_FALSE(store_->read_scene(*paths[0].scene_id + 1));
}

TEST_P(StoreConformance, EqualScenesAreKeptOnce) {
  RecordedScene same = kitchen();
  std::swap(same.objects[0], same.objects[1]);
  test::report(*store_, {with(solved(1), kitchen()), with(solved(2), same),
                         with(solved(3), kitchen(1.5)), with(solved(4), kitchen())});
  const auto paths = store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 10});
  ASSERT_EQ(paths.size(), 4U);
  EXPECT_EQ(paths[1].scene_id, paths[0].scene_id);
  EXPECT_EQ(paths[3].scene_id, paths[0].scene_id);
  EXPECT_NE(paths[2].scene_id, paths[0].scene_id);
}

TEST_P(StoreConformance, AConstraintIsKeptWithItsScene) {
  RecordedScene constrained = kitchen();
  constrained.constraint.emplace();
  constrained.constraint->bounds.row(1).setConstant(std::numeric_limits<double>::infinity());
  RecordedScene open;
  open.constraint = constrained.constraint;
  test::report(*store_, {with(solved(1), kitchen()), with(solved(2), constrained),
                         with(solved(3), open), with(solved(4), constrained)});
  reopen();
  const auto paths = store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 10});
  ASSERT_EQ(paths.size(), 4U);
  EXPECT_NE(paths[1].scene_id, paths[0].scene_id);
  EXPECT_NE(paths[2].scene_id, paths[1].scene_id);
  EXPECT_EQ(paths[3].scene_id, paths[1].scene_id);
  EXPECT_FALSE(store_->read_scene(paths[0].scene_id.value())->constraint);
  for (std::size_t i = 1; i < paths.size(); ++i) {
    const auto scene = store_->read_scene(paths[i].scene_id.value());
    ASSERT_TRUE(scene && scene->constraint) << i;
    EXPECT_EQ(scene->constraint->bounds, constrained.constraint->bounds);
  }
}

TEST_P(StoreConformance, ASceneIsPartOfAReportsBody) {
  report(with(solved(1), kitchen()));
  EXPECT_EQ(report(with(solved(1), kitchen())), ReceiptStatus::Duplicate);
  EXPECT_EQ(report(with(solved(1), kitchen(2))), ReceiptStatus::Refused);
  EXPECT_EQ(report(solved(1)), ReceiptStatus::Refused);
}

TEST_P(StoreConformance, ExportBringsScenesAndCountsThemToItsPages) {
  RecordedScene large;
  for (int i = 0; i < 100; ++i)
    large.objects.push_back({"box", BoxShape{{1, 1, 1 + 0.1 * i}}});
  test::report(*store_, {with(solved(1), large), with(solved(2), large), solved(3)});
  const Page<Attempt> all = store_->export_attempts({}, "", "", 10, 1'000'000);
  ASSERT_EQ(all.rows.size(), 3U);
  ASSERT_TRUE(all.rows[1].scene);
  EXPECT_EQ(content_digest(*all.rows[1].scene), content_digest(large));
  EXPECT_FALSE(all.rows[2].scene);
  EXPECT_EQ(store_->export_attempts({}, "", "", 10, scene_bytes(large)).rows.size(), 1U);
}

TEST_P(StoreConformance, ARetiredPathKeepsItsScene) {
  report(with(solved(1), kitchen()));
  store_->retire_path(test::id_from<Uuid>(1)).value_or_throw();
  EXPECT_TRUE(store_->find_attempt(test::id_from<Uuid>(1))->scene);
  EXPECT_EQ(report(with(solved(2), kitchen())), ReceiptStatus::Stored);
  EXPECT_TRUE(store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 9})[0].scene_id);
}

}  // namespace
}  // namespace kinship::store
