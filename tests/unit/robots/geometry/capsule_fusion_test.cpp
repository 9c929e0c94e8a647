#include "robots/geometry/link_shapes.hpp"

#include <gtest/gtest.h>

namespace kinship::geometry::capsule_fusion_test {
namespace {

constexpr double kRadius = 0.06, kLength = 0.4;

LinkShape cylinder(int link, const Eigen::Isometry3d& T_link_shape) {
  return {link, CylinderShape{kRadius, kLength}, T_link_shape};
}

LinkShape sphere(int link, const Eigen::Vector3d& p_link_center, double radius = kRadius) {
  return {link, SphereShape{radius}, Eigen::Isometry3d(Eigen::Translation3d(p_link_center))};
}

/// A cylinder that lies askew, so that its ends are nowhere simple.
Eigen::Isometry3d askew() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  T.translation() << 0.1, -0.2, 0.3;
  return T;
}

Eigen::Vector3d end_of(const Eigen::Isometry3d& T, double sign) {
  return T * Eigen::Vector3d(0, 0, sign * kLength / 2);
}

TEST(FuseCapsules, MakesOneCapsuleOfACylinderAndItsEndSpheres) {
  const Eigen::Isometry3d T = askew();
  const auto fused =
      fuse_capsules({sphere(1, end_of(T, -1)), cylinder(1, T), sphere(1, end_of(T, 1))});
  ASSERT_EQ(fused.size(), 1u);
  const auto* capsule = std::get_if<CapsuleShape>(&fused[0].shape);
  ASSERT_NE(capsule, nullptr);
  EXPECT_EQ(capsule->radius_m, kRadius);
  EXPECT_EQ(capsule->length_m, kLength);
  EXPECT_TRUE(fused[0].T_link_shape.isApprox(T));
}

TEST(FuseCapsules, LeavesACylinderWithOneSphereAlone) {
  const Eigen::Isometry3d T = askew();
  EXPECT_EQ(fuse_capsules({cylinder(1, T), sphere(1, end_of(T, 1))}).size(), 2u);
}

TEST(FuseCapsules, LeavesSpheresOfAnotherLinkOrRadiusOrPlaceAlone) {
  const Eigen::Isometry3d T = askew();
  const LinkShape top = sphere(1, end_of(T, 1));
  const double off = 2 * kFusionTolerance_m;
  EXPECT_EQ(fuse_capsules({cylinder(1, T), top, sphere(2, end_of(T, -1))}).size(), 3u);
  EXPECT_EQ(fuse_capsules({cylinder(1, T), top, sphere(1, end_of(T, -1), kRadius + off)}).size(),
            3u);
  EXPECT_EQ(
      fuse_capsules({cylinder(1, T), top, sphere(1, end_of(T, -1) + Eigen::Vector3d(off, 0, 0))})
          .size(),
      3u);
}

TEST(FuseCapsules, ToleratesTheRoundingOfAUrdf) {
  const Eigen::Isometry3d T = askew();
  const Eigen::Vector3d rounding = Eigen::Vector3d::Constant(0.5 * kFusionTolerance_m);
  EXPECT_EQ(
      fuse_capsules({cylinder(1, T), sphere(1, end_of(T, 1) + rounding), sphere(1, end_of(T, -1))})
          .size(),
      1u);
}

TEST(FuseCapsules, TwoCapsulesMayShareASphere) {
  const Eigen::Isometry3d lower = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d upper = lower;
  upper.translation().z() = kLength;
  const auto fused =
      fuse_capsules({cylinder(0, lower), cylinder(0, upper), sphere(0, end_of(lower, -1)),
                     sphere(0, end_of(lower, 1)), sphere(0, end_of(upper, 1))});
  ASSERT_EQ(fused.size(), 2u);
  for (const LinkShape& shape : fused)
    EXPECT_TRUE(std::holds_alternative<CapsuleShape>(shape.shape));
}

}  // namespace
}  // namespace kinship::geometry::capsule_fusion_test
