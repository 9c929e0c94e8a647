#include "robots/recall/clear_path.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "proto/types/recall_library.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/path_vertices.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::recall::clear_path_test {
namespace {

using planning::test_support::at;
using planning::test_support::square_bounds;
using planning::test_support::WallWorld;

constexpr std::uint64_t kSeed = 5;
constexpr double kStep = 0.05;
const WallWorld kSmall{.half_thickness = 0.1, .gap_lower = 0.5, .gap_upper = 0.9};
const WallWorld kLarge{.half_thickness = 0.15, .gap_lower = 0.55, .gap_upper = 0.85};

planning::IsFree free_in(const WallWorld& world) {
  return [world](const Eigen::VectorXd& q) { return world.free_at(q); };
}

std::optional<Eigen::MatrixXd> cleared(const Eigen::MatrixXd& path,
                                       const planning::IsFree& is_clear) {
  std::mt19937_64 generator(kSeed);
  return clear_path(path, is_clear, square_bounds(), {.step = kStep}, generator);
}

/// Through the gap, along its edge: as short as it goes. It ends beside the wall.
Eigen::MatrixXd tight_path(double end_x) {
  Eigen::MatrixXd path(2, 5);
  path << -0.8, -0.11, 0, 0.11, end_x, 0, 0.51, 0.51, 0.51, 0;
  return path;
}

TEST(ClearPath, IsFreeAmongTheLargerObstaclesButForItsEnds) {
  const Eigen::MatrixXd path = tight_path(0.12);
  ASSERT_TRUE(WallWorld(kSmall).path_is_free(path, kStep));
  const auto clear = cleared(path, free_in(kLarge));
  ASSERT_TRUE(clear);
  EXPECT_EQ(clear->col(0), path.col(0));
  EXPECT_EQ(clear->rightCols<1>(), path.rightCols<1>());
  EXPECT_TRUE(WallWorld(kSmall).path_is_free(*clear, kStep));
  Eigen::Index end = clear->cols() - 1;
  while (!kLarge.free_at(clear->col(end)))
    --end;
  ASSERT_LT(end, clear->cols() - 1) << "else the goal has room, and nothing of this is asked";
  ASSERT_GT(end, 1);
  EXPECT_TRUE(kLarge.path_is_free(clear->leftCols(end + 1), kStep));
  const Eigen::MatrixXd before = planning::densified(path, kStep);
  const Eigen::Index kept = clear->cols() - 1 - end;
  EXPECT_EQ(clear->rightCols(kept), before.rightCols(kept)) << "this piece stays as it was";
}

TEST(ClearPath, TheGivenOneWasNot) {
  EXPECT_FALSE(WallWorld(kLarge).path_is_free(tight_path(0.8), kStep));
  const auto clear = cleared(tight_path(0.8), free_in(kLarge));
  ASSERT_TRUE(clear);
  EXPECT_TRUE(WallWorld(kLarge).path_is_free(*clear, kStep));
}

TEST(ClearPath, AShortPieceMayBeginWithinTheLargerObstacles) {
  Eigen::MatrixXd path(2, 2);
  path << -0.8, 0.8, 0, 0;
  const auto beyond = [](double x) {
    return planning::IsFree([x](const Eigen::VectorXd& q) { return q[0] > x; });
  };
  const auto clear = cleared(path, beyond(-0.72));
  ASSERT_TRUE(clear);
  EXPECT_EQ(clear->col(0), path.col(0));
  EXPECT_FALSE(cleared(path, beyond(0)));
  EXPECT_FALSE(cleared(path, beyond(1))) << "nothing of it is free there";
}

TEST(ClearPath, ThereIsNoneIfTheLargerObstaclesCloseTheGap) {
  WallWorld closed = kLarge;
  closed.gap_lower = closed.gap_upper;
  std::mt19937_64 generator(kSeed);
  EXPECT_FALSE(clear_path(tight_path(0.8), free_in(closed), square_bounds(),
                          {.step = kStep, .plan_checks = 500}, generator));
}

TEST(EqualParts, LieOnThePathAndAreEquallyLong) {
  Eigen::MatrixXd path(2, 4);
  path << 0, 1, 1, 1, 0, 0, 0, 2.1;  // three long, with a waypoint twice
  const Eigen::MatrixXd parts = equal_parts(path);
  ASSERT_EQ(parts.cols(), kRecallWaypoints);
  EXPECT_EQ(parts.col(0), path.col(0));
  EXPECT_EQ(parts.rightCols<1>(), path.rightCols<1>());
  for (int i = 0; i < kRecallWaypoints; ++i) {
    const double along = 3.1 * i / (kRecallWaypoints - 1);
    const Eigen::Vector2d wanted =
        along < 1 ? Eigen::Vector2d(along, 0) : Eigen::Vector2d(1, along - 1);
    EXPECT_LT((parts.col(i) - wanted).norm(), 1e-12) << i;
  }
}

TEST(EqualParts, OfAPathWithoutLengthAreItsPlace) {
  const Eigen::MatrixXd parts = equal_parts(at(0.3, 0.4).replicate(1, 2));
  EXPECT_EQ(parts, at(0.3, 0.4).replicate(1, kRecallWaypoints));
}

TEST(Enlarged, EachShapeGrowsOnEverySide) {
  constexpr double kBy = 0.01;
  collision::Surroundings given;
  const Eigen::Isometry3d T(Eigen::Translation3d(1, 2, 3) *
                            Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
  given.T_task_base = T;
  given.scene.objects = {{"box", BoxShape{{0.1, 0.2, 0.3}}, T},
                         {"cylinder", CylinderShape{0.1, 0.5}, T},
                         {"sphere", SphereShape{0.2}, T},
                         {"capsule", CapsuleShape{0.1, 0.5}, T}};
  AttachedObject held;
  held.shape = BoxShape{{0.1, 0.1, 0.1}};
  given.attached = {held};
  const collision::Surroundings larger = enlarged(given, kBy);
  ASSERT_EQ(larger.scene.objects.size(), 4U);
  const auto& objects = larger.scene.objects;
  EXPECT_TRUE(
      std::get<BoxShape>(objects[0].shape).size.isApprox(Eigen::Vector3d(0.12, 0.22, 0.32)));
  EXPECT_NEAR(std::get<CylinderShape>(objects[1].shape).radius_m, 0.11, 1e-12);
  EXPECT_NEAR(std::get<CylinderShape>(objects[1].shape).length_m, 0.52, 1e-12);
  EXPECT_NEAR(std::get<SphereShape>(objects[2].shape).radius_m, 0.21, 1e-12);
  EXPECT_NEAR(std::get<CapsuleShape>(objects[3].shape).radius_m, 0.11, 1e-12);
  EXPECT_NEAR(std::get<CapsuleShape>(objects[3].shape).length_m, 0.5, 1e-12)
      << "its caps grow with the radius";
  for (const SceneObject& object : objects)
    EXPECT_EQ(object.T_task_object.matrix(), T.matrix()) << object.name;
  EXPECT_EQ(std::get<BoxShape>(larger.attached.front().shape).size, Eigen::Vector3d::Constant(0.1));
}

}  // namespace
}  // namespace kinship::recall::clear_path_test
