#include "robots/kinematics/axis_turns.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/support/random_chain.hpp"

namespace kinship::kinematics::axis_turns_test {
namespace {

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

Eigen::Matrix3d joined(const AxisTurns& turns) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  return about(z, turns.before) * about(x, std::atan2(turns.tilt_sine, turns.tilt_cosine)) *
         about(z, turns.after);
}

TEST(AxisTurns, MakeTheRotation) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Matrix3d R = test::random_pose(1, generator).linear();
    EXPECT_LT((joined(axis_turns(R)) - R).norm(), 1e-14) << R;
  }
}

TEST(AxisTurns, MakeItAlsoWhereTheAxesAreNearlyParallel) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  for (const double over : {0.0, M_PI})
    for (const double tilt : {0.0, 1e-15, 1e-13, 1e-10, 1e-7, -1e-11})
      for (const double turn : {0.0, 0.7, -2.5, M_PI}) {
        const Eigen::Matrix3d R = about(z, 0.4) * about(x, over + tilt) * about(z, turn);
        EXPECT_LT((joined(axis_turns(R)) - R).norm(), 2e-12) << over << " " << tilt << " " << turn;
      }
}

}  // namespace
}  // namespace kinship::kinematics::axis_turns_test
