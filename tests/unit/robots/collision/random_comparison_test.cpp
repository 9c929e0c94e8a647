#include <gtest/gtest.h>

#include "robots/collision/convex_distance.hpp"
#include "robots/collision/solid.hpp"
#include "tests/property/random_worlds.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/unit/robots/collision/nearest_points.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::random_comparison_test {
namespace {

using namespace test_support;

constexpr double kTouching_m = 1e-7, kApart_m = 1e-4;  // between them the reference cannot say

TEST(Touch, AgreesWithAlternatingProjections) {
  test::Random random;
  int touching = 0, apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Shape a = random.shape(0.6), b = random.shape(0.6);
    const Eigen::Isometry3d T_base_a = random.pose(0.2), T_base_b = random.pose(0.2);
    const double distance = distance_m(a, T_base_a, b, T_base_b);
    if (distance > kTouching_m && distance < kApart_m)
      continue;
    const bool expected = distance <= kTouching_m;
    (expected ? touching : apart) += 1;
    ASSERT_EQ(touch(Solid(a), T_base_a, Solid(b), T_base_b), expected)
        << "pair " << i << ", shapes " << a.index() << " and " << b.index() << ", distance "
        << distance;
  }
  EXPECT_GT(touching, 400);
  EXPECT_GT(apart, 400);
}

TEST(ConvexDistance, IsNeverAboveThatOfAlternatingProjectionsAndHardlyBelow) {
  test::Random random;
  int apart = 0;
  for (int i = 0; i < 2000; ++i) {
    const Shape a = random.shape(0.6), b = random.shape(0.6);
    const double reach_m = i % 2 == 0 ? 0.3 : 1;
    const Eigen::Isometry3d T_base_a = random.pose(reach_m), T_base_b = random.pose(reach_m);
    const double distance = distance_m(a, T_base_a, b, T_base_b);
    const double bound = convex_distance_m(a, T_base_a, b, T_base_b);
    const double cheap = cheap_distance_m(Solid(a), T_base_a, Solid(b), T_base_b);
    ASSERT_LE(bound, distance) << "pair " << i << ", shapes " << a.index() << " and " << b.index();
    ASSERT_LE(cheap, distance) << "pair " << i;
    ASSERT_GE(bound, 0.985 * distance - 1e-5)
        << "pair " << i << ", shapes " << a.index() << " and " << b.index();
    apart += distance > kApart_m ? 1 : 0;
  }
  EXPECT_GT(apart, 800);
}

TEST(CloseDistance, OfAMeshIsNeverAboveThatOfAlternatingProjections) {
  test::Random random;
  int apart = 0;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d size(random.number(0.05, 0.5), random.number(0.05, 0.5),
                               random.number(0.05, 0.5));
    const Eigen::Matrix3Xd triangles = test::BoxMesh(size).triangles().colwise() - size / 2;
    const Shape a = BoxShape{size}, b = random.shape(0.6);
    const Eigen::Isometry3d T_base_a = random.pose(0.5), T_base_b = random.pose(0.5);
    const double distance = distance_m(a, T_base_a, b, T_base_b);
    if (distance < kApart_m)
      continue;  // what lies within a mesh does not touch it
    ++apart;
    const Solid mesh(a, &triangles), other(b);
    const double close = close_distance_m(mesh, T_base_a, other, T_base_b, 1e9);
    const double enough = close_distance_m(mesh, T_base_a, other, T_base_b, distance / 2);
    ASSERT_LE(enough, distance) << "pair " << i << ", shape " << b.index();
    ASSERT_GE(enough, 0.49 * distance - 1e-4) << "pair " << i << ", shape " << b.index();
    ASSERT_LE(close, distance) << "pair " << i << ", shape " << b.index();
    ASSERT_GE(close, 0.98 * distance - 3e-4) << "pair " << i << ", shape " << b.index();
  }
  EXPECT_GT(apart, 400);
}

/// Poses of the toy arm's link shapes, by the formula for a planar arm.
std::vector<Eigen::Isometry3d> shape_poses(const geometry::RobotShapes& shapes,
                                           const Eigen::VectorXd& q) {
  std::vector<Eigen::Isometry3d> poses;
  double x = 0, y = 0, angle = 0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    angle += q[i];
    Eigen::Isometry3d T = shift(x, y);
    T.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    poses.push_back(T * shift(kLink_m) * shapes.shapes[static_cast<std::size_t>(i)].T_link_shape);
    x += kLink_m * std::cos(angle);
    y += kLink_m * std::sin(angle);
  }
  return poses;
}

TEST(CollisionWorld, AgreesWithDistancesOfAPlanarArm) {
  test::Random random;
  constexpr int kJoints = 4;
  const auto shapes = toy_shapes(kJoints);
  Surroundings surroundings;
  surroundings.T_task_base = random.pose(1.0);
  for (int i = 0; i < 6; ++i)
    surroundings.scene.objects.push_back({"object" + std::to_string(i), random.shape(0.6),
                                          surroundings.T_task_base * random.pose(1.2)});
  CollisionWorld world(toy_chain(kJoints), shapes, surroundings);
  const Eigen::Isometry3d T_base_task = surroundings.T_task_base.inverse();
  int collisions = 0;
  constexpr int kConfigurations = 100;
  for (int i = 0; i < kConfigurations; ++i) {
    const Eigen::VectorXd q =
        Eigen::VectorXd::NullaryExpr(kJoints, [&] { return random.number(-M_PI, M_PI); });
    const auto poses = shape_poses(shapes, q);
    double nearest = 1e9;
    for (std::size_t a = 0; a < poses.size(); ++a) {
      for (const SceneObject& object : surroundings.scene.objects)
        nearest = std::min(nearest, distance_m(shapes.shapes[a].shape, poses[a], object.shape,
                                               T_base_task * object.T_task_object));
      for (std::size_t b = a + 2; b < poses.size(); ++b)
        nearest = std::min(nearest, distance_m(shapes.shapes[a].shape, poses[a],
                                               shapes.shapes[b].shape, poses[b]));
    }
    if (nearest > kTouching_m && nearest < kApart_m)
      continue;
    collisions += nearest <= kTouching_m;
    ASSERT_EQ(world.collides(q), nearest <= kTouching_m) << q.transpose();
  }
  EXPECT_GT(collisions, kConfigurations / 10);
  EXPECT_LT(collisions, kConfigurations * 9 / 10);
}

}  // namespace
}  // namespace kinship::collision::random_comparison_test
