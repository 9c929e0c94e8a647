#include "robots/planning/kept_orientation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace kinship::planning {
namespace {

Eigen::Matrix3d turn(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

/// What MoveIt compares with the tolerances: a, b and c of Rx(a) Ry(b) Rz(c), or a rotation vector.
Eigen::Vector3d compared(const Eigen::Matrix3d& R, bool is_vector) {
  if (is_vector) {
    const Eigen::AngleAxisd vector(R);
    return vector.angle() * vector.axis();
  }
  return {std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)), std::atan2(-R(0, 1), R(0, 0))};
}

/// The largest part of a tolerance that an orientation of the region takes, of many, a third of
/// them at corners of its box.
double largest_part(const Eigen::Vector3d& bounds, const Eigen::Vector3d& tolerances,
                    bool is_vector) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> within(-1, 1);
  double largest = 0;
  for (int i = 0; i < 30'000; ++i) {
    Eigen::Vector3d rpy(within(generator), within(generator), within(generator));
    if (i % 3 > 0)  // of a face or an edge, where the largest ones are
      rpy[i % 2] = std::copysign(1, rpy[i % 2]);
    if (i % 3 > 1)
      rpy[2] = std::copysign(1, rpy[2]);
    rpy = rpy.cwiseProduct(bounds).eval();
    const Eigen::Matrix3d R = turn(rpy.z(), Eigen::Vector3d::UnitZ()) *
                              turn(rpy.y(), Eigen::Vector3d::UnitY()) *
                              turn(rpy.x(), Eigen::Vector3d::UnitX());
    largest =
        std::max(largest, compared(R, is_vector).cwiseAbs().cwiseQuotient(tolerances).maxCoeff());
  }
  return largest;
}

TEST(KeptOrientation, WhateverARegionWithThreeBoundsAllowsTheTolerancesAllow) {
  const Eigen::Vector3d asked[] = {{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2},   {0.3, 0.3, 0.3},
                                   {0.5, 0.5, 0.5}, {1.2, 1.2, 1.2},   {0.125, 0.25, 0.5},
                                   {1, 0.3, 0.2},   {0.05, 0.05, 1.4}, {0.1, 0.2, 3},
                                   {3, 3, 3},       {0.2, 1.6, 0.3}};
  for (const bool is_vector : {false, true})
    for (const Eigen::Vector3d& tolerances : asked) {
      const auto kept = keep_orientation(tolerances, is_vector);
      ASSERT_TRUE(kept);
      const double largest = largest_part(kept->bounds, tolerances, is_vector);
      EXPECT_LE(largest, 1) << tolerances.transpose() << (is_vector ? ", a vector" : "");
      // Nothing is given away below 1.5 rad: a box a little larger is not within.
      if (kept->bounds.maxCoeff() > 1.45)
        continue;
      EXPECT_GT(largest_part(1.04 * kept->bounds, tolerances, is_vector), 1)
          << tolerances.transpose() << (is_vector ? ", a vector: " : ": ") << largest;
    }
}

TEST(KeptOrientation, ATurnAboutOneAxisAloneIsTheSameInEitherOrder) {
  const Eigen::Vector3d tolerances(0, 0, 0.4);
  const auto kept = keep_orientation(tolerances, false);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->bounds, tolerances);
  EXPECT_EQ(kept->difference, "");
}

}  // namespace
}  // namespace kinship::planning
