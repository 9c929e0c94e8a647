#include "robots/collision/solid.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/types/failure.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::solid_test {
namespace {

using test_support::shift;

bool touch_at(const Shape& a, const Shape& b, const Eigen::Isometry3d& T_a_b) {
  const Eigen::Isometry3d T_base_a = shift(0.3, -0.2, 1.1);  // anywhere but the origin
  const bool there = touch(Solid(a), T_base_a, Solid(b), T_base_a * T_a_b);
  const bool back = touch(Solid(b), T_base_a * T_a_b, Solid(a), T_base_a);
  EXPECT_EQ(there, back);
  return there;
}

/// The second shape, moved along x, touches up to `reach` and not beyond.
void expect_reach(const Shape& a, const Shape& b, double reach_m) {
  EXPECT_TRUE(touch_at(a, b, shift(reach_m - 1e-4)));
  EXPECT_FALSE(touch_at(a, b, shift(reach_m + 1e-4)));
}

TEST(Solid, EveryPairOfShapesTouchesUpToItsReach) {
  const Shape box = BoxShape{{0.2, 0.4, 0.6}};
  const Shape cylinder = CylinderShape{0.3, 0.5};
  const Shape sphere = SphereShape{0.25};
  const Shape capsule = CapsuleShape{0.15, 0.8};
  expect_reach(box, box, 0.2);
  expect_reach(box, cylinder, 0.4);
  expect_reach(box, sphere, 0.35);
  expect_reach(box, capsule, 0.25);
  expect_reach(cylinder, cylinder, 0.6);
  expect_reach(cylinder, sphere, 0.55);
  expect_reach(cylinder, capsule, 0.45);
  expect_reach(sphere, sphere, 0.5);
  expect_reach(sphere, capsule, 0.4);
  expect_reach(capsule, capsule, 0.3);
}

TEST(Solid, ASizeIsAFullExtentAndACapsuleEndsInHalfSpheres) {
  const Shape needle = BoxShape{{0.001, 0.001, 0.001}};
  const auto reach_along_z = [&](const Shape& shape, double z) {
    return touch_at(shape, needle, shift(0, 0, z));
  };
  EXPECT_TRUE(reach_along_z(BoxShape{{1, 1, 0.6}}, 0.3));
  EXPECT_FALSE(reach_along_z(BoxShape{{1, 1, 0.6}}, 0.301));
  EXPECT_TRUE(reach_along_z(CylinderShape{1, 0.6}, 0.3));
  EXPECT_FALSE(reach_along_z(CylinderShape{1, 0.6}, 0.301));
  EXPECT_TRUE(reach_along_z(CapsuleShape{0.1, 0.6}, 0.4));
  EXPECT_FALSE(reach_along_z(CapsuleShape{0.1, 0.6}, 0.401));
}

TEST(Solid, OneInsideAnotherTouches) {
  const Shape large = BoxShape{{2, 2, 2}};
  for (const Shape& small : {Shape(BoxShape{{0.1, 0.1, 0.1}}), Shape(SphereShape{0.1}),
                             Shape(CapsuleShape{0.1, 0.2}), Shape(CylinderShape{0.1, 0.2})})
    EXPECT_TRUE(touch_at(large, small, shift(0.3, 0.2, 0.1)));
}

TEST(Solid, BoxCylinderCornersAreExact) {
  // The cylinder's rim passes the box's vertical edge at a distance of (sqrt 2 - 1) times 0.1.
  const Shape box = BoxShape{{0.2, 0.2, 0.2}};
  const Shape cylinder = CylinderShape{0.1, 0.2};
  const double diagonal = 0.1 + 0.1 / std::sqrt(2.0);
  EXPECT_TRUE(touch_at(box, cylinder, shift(diagonal - 1e-4, diagonal - 1e-4)));
  EXPECT_FALSE(touch_at(box, cylinder, shift(diagonal + 1e-4, diagonal + 1e-4)));
}

/// A column of 0.8 m with a shelf of 0.4 m at its foot, about the middle of the box around both.
Solid column_and_shelf() {
  const Eigen::Matrix3Xd column = kinship::test::BoxMesh({0.1, 0.3, 0.8}).triangles();
  const Eigen::Matrix3Xd shelf = kinship::test::BoxMesh({0.5, 0.3, 0.1}).triangles();
  Eigen::Matrix3Xd both(3, column.cols() + shelf.cols());
  both << column, shelf;
  both.colwise() -= Eigen::Vector3d(0.25, 0.15, 0.4);
  return Solid(BoxShape{{0.5, 0.3, 0.8}}, &both);
}

TEST(Solid, AMeshTouchesWhereItsTrianglesAre) {
  const Solid mesh = column_and_shelf();
  const Eigen::Isometry3d T_base_mesh = shift(0.3, -0.2, 1.1);
  const auto touches_at = [&](const Shape& shape, double x, double y, double z) {
    const Eigen::Isometry3d T_base_other = T_base_mesh * shift(x, y, z);
    const bool there = touch(mesh, T_base_mesh, Solid(shape), T_base_other);
    EXPECT_EQ(there, touch(Solid(shape), T_base_other, mesh, T_base_mesh));
    return there;
  };
  for (const Shape& shape : {Shape(SphereShape{0.1}), Shape(BoxShape{{0.2, 0.2, 0.2}}),
                             Shape(CapsuleShape{0.1, 0.05}), Shape(CylinderShape{0.1, 0.2})}) {
    EXPECT_FALSE(touches_at(shape, 0.1, 0, 0.1)) << "above the shelf";
    EXPECT_TRUE(touches_at(shape, 0.1, 0, -0.22)) << "on the shelf";
    EXPECT_TRUE(touches_at(shape, -0.1, 0, 0.1)) << "at the column";
    EXPECT_FALSE(touches_at(shape, 0.1, 0.3, -0.3)) << "beside it";
  }
}

TEST(Solid, MeshesTouchEachOther) {
  const Solid mesh = column_and_shelf();
  Eigen::Isometry3d T_turned = shift(0.3, -0.2, 1.1);
  T_turned.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()));  // each in the other's corner
  const Eigen::Isometry3d T = shift(0.3, -0.2, 1.1);
  EXPECT_FALSE(touch(mesh, T, mesh, shift(0.15, 0, 0.15) * T_turned));
  EXPECT_TRUE(touch(mesh, T, mesh, shift(0, 0.01, -0.05) * T_turned));
  EXPECT_TRUE(touch(mesh, T, mesh, shift(0.02, 0.01, 0.03) * T));
}

TEST(Solid, RefusesWhatIsNoShape) {
  const Eigen::Matrix3Xd eight = Eigen::Matrix3Xd::Ones(3, 8), none(3, 0);
  EXPECT_THROW(Solid(BoxShape{{1, 1, 1}}, &eight), Failure);
  EXPECT_THROW(Solid(BoxShape{{1, 1, 1}}, &none), Failure);
  EXPECT_THROW(Solid(SphereShape{0}), Failure);
  EXPECT_THROW(Solid(BoxShape{{1, NAN, 1}}), Failure);
}

}  // namespace
}  // namespace kinship::collision::solid_test
