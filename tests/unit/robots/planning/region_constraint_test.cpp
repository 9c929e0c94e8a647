#include "robots/planning/region_constraint.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/robots.hpp"

namespace kinship::planning::region_constraint_test {
namespace {

using Vector6 = RegionConstraint::Vector6;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Displacement of a pose in words of the file format: T0_w^-1 * T * Tw_e^-1 as x y z, Rz Ry Rx.
Eigen::Isometry3d displaced(const Vector6& d) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = d.head<3>();
  T.rotate(Eigen::AngleAxisd(d[5], Eigen::Vector3d::UnitZ()));
  T.rotate(Eigen::AngleAxisd(d[4], Eigen::Vector3d::UnitY()));
  T.rotate(Eigen::AngleAxisd(d[3], Eigen::Vector3d::UnitX()));
  return T;
}

Eigen::Isometry3d some_pose(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> unit(-1, 1);
  return displaced(Vector6::NullaryExpr([&] { return unit(generator); }));
}

Eigen::Matrix2Xd limits_of(const kinematics::Chain& chain) {
  Eigen::Matrix2Xd bounds(2, chain.dof());
  bounds << chain.lower().transpose(), chain.upper().transpose();
  return bounds;
}

TaskSpaceRegion box(const Vector6& lower, const Vector6& upper) {
  TaskSpaceRegion region;
  region.bounds << lower.transpose(), upper.transpose();
  return region;
}

TEST(RegionConstraint, ExcessIsTheDisplacementBeyondTheBounds) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> small(-0.7, 0.7);
  for (const char* robot : {"panda", "ur10e", "sara_like"}) {
    const kinematics::Chain chain = test::model_chain(robot);
    for (int i = 0; i < 50; ++i) {
      const Eigen::VectorXd q = test::random_configuration(chain, generator);
      const Eigen::Isometry3d T_task_base = some_pose(generator);
      const Vector6 d = Vector6::NullaryExpr([&] { return small(generator); });
      // Placed such that q has displacement d, whatever Tw_e is.
      TaskSpaceRegion region = box(Vector6::Constant(-0.1), Vector6::Constant(0.2));
      region.T_region_end = some_pose(generator);
      region.T_task_region = T_task_base * kinematics::T_base_transfer(chain, q) *
                             region.T_region_end.inverse() * displaced(d).inverse();
      const RegionConstraint constraint(chain, region, T_task_base, limits_of(chain));
      const Vector6 expected = d - d.cwiseMax(-0.1).cwiseMin(0.2);
      EXPECT_LT((constraint.excess(q) - expected).norm(), 1e-9) << robot;
      EXPECT_NEAR(constraint.distance(q), expected.norm(), 1e-9);
    }
  }
}

TEST(RegionConstraint, ItsDerivativeIsThatOfTheExcess) {
  std::mt19937_64 generator(4);
  for (const char* robot : {"panda", "sara_like"}) {
    const kinematics::Chain chain = test::model_chain(robot);
    TaskSpaceRegion region = box(Vector6::Constant(5), Vector6::Constant(5));  // always outside
    region.bounds.rightCols<3>().setConstant(0.1);
    region.T_region_end = some_pose(generator);
    const RegionConstraint constraint(chain, region, some_pose(generator), limits_of(chain));
    int compared = 0;
    for (int i = 0; i < 50; ++i) {
      const Eigen::VectorXd q = test::random_configuration(chain, generator);
      const RegionConstraint::Matrix6 J = constraint.derivative(q);
      if (J.cwiseAbs().maxCoeff() > 5)
        continue;  // near a pitch of 90 degrees
      constexpr double kDelta = 1e-6;
      Eigen::MatrixXd expected(6, chain.dof());
      for (Eigen::Index j = 0; j < chain.dof(); ++j) {
        Eigen::VectorXd after = q, before = q;
        after[j] += kDelta;
        before[j] -= kDelta;
        expected.col(j) = (constraint.excess(after) - constraint.excess(before)) / (2 * kDelta);
      }
      if (expected.cwiseAbs().maxCoeff() > 100)
        continue;  // an angle went round
      EXPECT_LT((J - expected).cwiseAbs().maxCoeff(), 1e-5) << robot << " " << q.transpose();
      ++compared;
    }
    EXPECT_GT(compared, 20);
  }
}

TEST(RegionConstraint, AnglesCountModuloATurnAndInTheNearerOfTwoWritings) {
  const kinematics::Chain chain = test::PlanarArm{{0.5, 0.5}}.chain();
  Vector6 lower = Vector6::Zero(), upper = Vector6::Zero();
  lower.head<3>().setConstant(-kInfinity);
  upper.head<3>().setConstant(kInfinity);
  lower[5] = 3.0, upper[5] = 3.4;  // about pi
  const RegionConstraint yaw(chain, box(lower, upper), Eigen::Isometry3d::Identity(),
                             limits_of(chain));
  EXPECT_EQ(yaw.distance(Eigen::Vector2d(-1.5, -1.5)), 0);  // -3 is 3.28
  EXPECT_NEAR(yaw.distance(Eigen::Vector2d(-1.4, -1.4)), 2 * M_PI - 2.8 - 3.4, 1e-9);

  // Pitch about pi, level otherwise: R = Ry(pi) is also roll pi, pitch 0, yaw pi.
  lower[4] = M_PI - 0.1, upper[4] = M_PI + 0.1, lower[5] = upper[5] = 0;
  TaskSpaceRegion over = box(lower, upper);
  over.T_region_end.rotate(Eigen::AngleAxisd(-M_PI, Eigen::Vector3d::UnitY()));
  const RegionConstraint pitch(chain, over, Eigen::Isometry3d::Identity(), limits_of(chain));
  EXPECT_NEAR(pitch.distance(Eigen::Vector2d(0.4, -0.4)), 0, 1e-9);
}

TEST(RegionConstraint, OneBoundOfAnAngleLeavesHalfATurn) {
  const kinematics::Chain chain = test::PlanarArm{{0.5, 0.5}}.chain();
  Vector6 lower = Vector6::Constant(-kInfinity), upper = Vector6::Constant(kInfinity);
  lower[5] = -0.1;
  lower[3] = lower[4] = upper[3] = upper[4] = 0;  // or a yaw further by half a turn would do too
  const RegionConstraint constraint(chain, box(lower, upper), Eigen::Isometry3d::Identity(),
                                    limits_of(chain));
  EXPECT_EQ(constraint.distance(Eigen::Vector2d(1.5, 1.5)), 0);
  EXPECT_NEAR(constraint.distance(Eigen::Vector2d(-0.5, 0)), 0.4, 1e-9);
}

TaskSpaceRegion upright(double tilt_rad) {
  Vector6 lower = Vector6::Constant(-kInfinity), upper = Vector6::Constant(kInfinity);
  lower.segment<2>(3).setConstant(-tilt_rad);
  upper.segment<2>(3).setConstant(tilt_rad);
  TaskSpaceRegion region = box(lower, upper);
  region.T_region_end.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  return region;
}

TEST(RegionConstraint, ProjectsConfigurationsNearbyWithoutLeavingTheBounds) {
  std::mt19937_64 generator(2);
  std::normal_distribution<double> near(0, 0.1);
  for (const char* robot : {"panda", "ur10e", "iiwa14", "sawyer", "sara_like"}) {
    const kinematics::Chain chain = test::model_chain(robot);
    const Eigen::Matrix2Xd bounds = limits_of(chain);
    RegionConstraint constraint(chain, upright(0.15), Eigen::Isometry3d::Identity(), bounds);
    int found = 0, back = 0;
    for (int i = 0; i < 200; ++i) {
      Eigen::VectorXd q = test::random_configuration(chain, generator);
      if (!constraint.project(q))
        continue;
      ++found;
      EXPECT_LE(constraint.distance(q), RegionConstraint::kWaypointTolerance / 2 + 1e-12);
      EXPECT_TRUE(chain.within_limits(q));
      const Eigen::VectorXd held = q;
      for (double& value : q)
        value += near(generator);
      q = q.cwiseMax(chain.lower()).cwiseMin(chain.upper());
      const double off = (q - held).norm();
      if (constraint.project(q))
        back += (q - held).norm() <= 1.5 * off;
    }
    EXPECT_GT(found, 60) << robot;
    EXPECT_GT(back, 0.97 * found) << robot;
    EXPECT_GT(constraint.projections(), 260u);
  }
}

TEST(RegionConstraint, ProjectsOntoAPoseAndALine) {
  const kinematics::Chain chain = test::model_chain("panda");
  const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
  TaskSpaceRegion region;  // all six fixed
  region.T_task_region = kinematics::T_base_transfer(chain, middle);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> near(0, 0.2);
  for (const double length_m : {0.0, 0.3}) {
    region.bounds(1, 2) = length_m;
    RegionConstraint constraint(chain, region, Eigen::Isometry3d::Identity(), limits_of(chain));
    EXPECT_TRUE(constraint.holds(middle));
    for (int i = 0; i < 50; ++i) {
      Eigen::VectorXd q = middle;
      for (double& value : q)
        value += near(generator);
      EXPECT_TRUE(constraint.project(q));
      const Eigen::Isometry3d T =
          region.T_task_region.inverse() * kinematics::T_base_transfer(chain, q);
      EXPECT_LT(T.translation().head<2>().norm(), 1e-3);
      EXPECT_LT(Eigen::AngleAxisd(T.linear()).angle(), 1e-3);
    }
  }
}

TEST(RegionConstraint, SaysWhenItDoesNotArrive) {
  const kinematics::Chain chain = test::PlanarArm{{0.5, 0.5}}.chain();
  TaskSpaceRegion region;
  region.T_task_region.translation().x() = 2;  // out of reach
  RegionConstraint constraint(chain, region, Eigen::Isometry3d::Identity(), limits_of(chain));
  Eigen::VectorXd q = Eigen::Vector2d(0.3, 0.4);
  EXPECT_FALSE(constraint.project(q));
  EXPECT_TRUE(q.allFinite());
  EXPECT_TRUE(chain.within_limits(q));
  EXPECT_EQ(constraint.projections(), 1u);
}

TEST(RegionConstraint, RefusesWhatDoesNotFit) {
  const kinematics::Chain chain = test::PlanarArm{{0.5, 0.5}}.chain();
  TaskSpaceRegion crossed;
  crossed.bounds.col(4) << 0.2, 0.1;
  const auto make = [&](const TaskSpaceRegion& region, const Eigen::Matrix2Xd& bounds) {
    return RegionConstraint(chain, region, Eigen::Isometry3d::Identity(), bounds);
  };
  EXPECT_THROW(make(crossed, limits_of(chain)), std::invalid_argument);
  EXPECT_THROW(make({}, Eigen::Matrix2Xd::Zero(2, 3)), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::planning::region_constraint_test
