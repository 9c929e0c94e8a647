#include "robots/geometry/shape_rules.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace kinship::geometry::shape_rules_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(BrokenRule, SoundShapesBreakNone) {
  EXPECT_FALSE(broken_rule(BoxShape{{1, 2, 3}}));
  EXPECT_FALSE(broken_rule(CylinderShape{0.1, 0.2}));
  EXPECT_FALSE(broken_rule(SphereShape{0.1}));
  EXPECT_FALSE(broken_rule(CapsuleShape{0.1, 0}));
}

TEST(BrokenRule, EverySizeMustBePositiveAndFinite) {
  for (const double bad : {0.0, -1.0, kNan, kInfinity, 2 * kMaxShape_m}) {
    EXPECT_TRUE(broken_rule(BoxShape{{bad, 1, 1}})) << bad;
    EXPECT_TRUE(broken_rule(BoxShape{{1, bad, 1}})) << bad;
    EXPECT_TRUE(broken_rule(BoxShape{{1, 1, bad}})) << bad;
    EXPECT_TRUE(broken_rule(CylinderShape{bad, 1})) << bad;
    EXPECT_TRUE(broken_rule(CylinderShape{1, bad})) << bad;
    EXPECT_TRUE(broken_rule(SphereShape{bad})) << bad;
    EXPECT_TRUE(broken_rule(CapsuleShape{bad, 1})) << bad;
  }
  EXPECT_TRUE(broken_rule(CapsuleShape{1, -1}));
}

TEST(BrokenRule, NamesSizeAndValue) {
  EXPECT_EQ(broken_rule(CylinderShape{1, -0.5}),
            "cylinder length of -0.5 m is not between 0 and 1000 m");
}

TEST(HalfExtents, AreThoseOfTheBoxAroundAShape) {
  EXPECT_EQ(half_extents_m(BoxShape{{1, 2, 3}}), Eigen::Vector3d(0.5, 1, 1.5));
  EXPECT_EQ(half_extents_m(CylinderShape{0.25, 3}), Eigen::Vector3d(0.25, 0.25, 1.5));
  EXPECT_EQ(half_extents_m(SphereShape{0.25}), Eigen::Vector3d(0.25, 0.25, 0.25));
  EXPECT_EQ(half_extents_m(CapsuleShape{0.25, 3}), Eigen::Vector3d(0.25, 0.25, 1.75));
}

}  // namespace
}  // namespace kinship::geometry::shape_rules_test
