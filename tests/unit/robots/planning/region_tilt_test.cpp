// Where roll and pitch alone are bounded only a row of the rotation is looked at. A bound of x that
// is never met makes the constraint look at the whole pose: both must answer alike.

#include <gtest/gtest.h>

#include <limits>

#include "robots/planning/region_constraint.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"

namespace kinship::planning::region_tilt_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Comparison {
  int arrived = 0, alike = 0;
};

void compare(const kinematics::Chain& chain, TaskSpaceRegion region, std::mt19937_64& generator,
             Comparison& found) {
  const Eigen::Isometry3d T_task_base = test::random_pose(0.5, generator);
  Eigen::Matrix2Xd limits(2, chain.dof());
  limits << chain.lower().transpose(), chain.upper().transpose();
  RegionConstraint tilt(chain, region, T_task_base, limits);
  region.bounds.col(0) << -1e3, 1e3;
  RegionConstraint pose(chain, region, T_task_base, limits);
  for (int i = 0; i < 50; ++i) {
    Eigen::VectorXd q = test::random_configuration(chain, generator), other = q;
    ASSERT_LT((tilt.excess(q) - pose.excess(q)).norm(), 1e-9) << q.transpose();
    const bool arrived = tilt.project(q), others = pose.project(other);
    ASSERT_EQ(arrived, tilt.distance(q) <= RegionConstraint::kWaypointTolerance / 2);
    ASSERT_TRUE(chain.within_limits(q));
    found.arrived += others;
    found.alike += arrived && others && (q - other).norm() < 1e-6;
  }
}

TaskSpaceRegion tilted(double roll, double roll_width, double pitch, double pitch_width) {
  TaskSpaceRegion region;
  region.bounds.row(0).setConstant(-kInfinity);
  region.bounds.row(1).setConstant(kInfinity);
  region.bounds.col(3) << roll - roll_width / 2, roll + roll_width / 2;
  region.bounds.col(4) << pitch - pitch_width / 2, pitch + pitch_width / 2;
  return region;
}

TEST(RegionTilt, AnswersAsTheWholePoseDoes) {
  std::mt19937_64 generator(1);
  const TaskSpaceRegion regions[] = {upright_region(0.15),    upright_region(1.2),
                                     tilted(0, 0, 0, 0),      tilted(3, 0.4, 0.2, 0.1),
                                     tilted(-1, 4, 0.3, 0.2), tilted(0.5, 0.5, M_PI, 0.3),
                                     tilted(0.2, 0.1, 0, 7),  tilted(0.3, 7, 0.2, 0.1)};
  for (const TaskSpaceRegion& region : regions) {
    Comparison found;
    for (const char* robot : {"panda", "ur10e"})
      compare(test::model_chain(robot), region, generator, found);
    for (int chain = 0; chain < 6; ++chain) {
      const int joints = 1 + chain;
      compare(test::random_chain({.joints = joints, .sliding_share = 0.2}, generator), region,
              generator, found);
    }
    EXPECT_GT(found.arrived, 60) << region.bounds;
    // A start where a step hardly knows where to go leads elsewhere after rounding.
    EXPECT_GT(found.alike, 0.95 * found.arrived) << region.bounds;
  }
}

}  // namespace
}  // namespace kinship::planning::region_tilt_test
