#include "robots/collision/lane_layout.hpp"

#include <gtest/gtest.h>

namespace kinship::collision::lane_layout_test {
namespace {

Eigen::Matrix3d turned(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle_rad, axis.normalized()).toRotationMatrix();
}

TEST(LaneLayout, QuarterTurnsMapAxesToAxes) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(is_of_quarter_turns(Eigen::Matrix3d::Identity()));
  EXPECT_TRUE(is_of_quarter_turns(turned(M_PI / 2, z) * turned(-M_PI, x)));
  EXPECT_FALSE(is_of_quarter_turns(turned(1e-6, z)));
  EXPECT_FALSE(is_of_quarter_turns(turned(M_PI / 4, x)));
}

TEST(LaneLayout, TheAxesOfMostBoxesAreTaken) {
  const Eigen::Matrix3d square = turned(0.4, {1, 2, 3}), odd = turned(1.1, {3, -1, 1});
  const Eigen::Matrix3d quarter = turned(M_PI / 2, Eigen::Vector3d::UnitY());
  const Eigen::Matrix3d found = common_axes({odd, square, square * quarter, square});
  EXPECT_TRUE(is_of_quarter_turns(found.transpose() * square));
  EXPECT_TRUE(common_axes({}).isIdentity());
}

}  // namespace
}  // namespace kinship::collision::lane_layout_test
