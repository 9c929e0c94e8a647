#include <gtest/gtest.h>

#include <vector>

#include "robots/inverse/closed_form.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/screw_arm.hpp"
#include "tests/unit/robots/inverse/checked_inverse.hpp"

namespace kinship::inverse::out_of_reach_test {
namespace {

using kinematics::Chain;
using kinematics::JointType;
using kinematics::T_base_tip;
using test::arms::kX, test::arms::kY, test::arms::kZ;
constexpr std::uint64_t kSeed = 41;
constexpr double kMillimetre = 1e-3;

Eigen::Isometry3d moved(Eigen::Isometry3d T, const Eigen::Vector3d& by) {
  T.translation() += by;
  return T;
}

/// The stretched arm, and the direction in which its wrist is stretched out.
Eigen::VectorXd stretched() {
  Eigen::VectorXd q(6);
  q << 0.3, 0.5, IndustrialArm::straight(), 1.1, -0.8, 0.2;
  return q;
}
Eigen::Vector3d outward() { return Eigen::AngleAxisd(0.3, kZ) * (Eigen::AngleAxisd(0.5, kY) * kZ); }

/// Moved along itself, the arm reaches a pose or it does not: the wrist is all that counts.
TEST(OutOfReach, AMillimetreDecides) {
  for (const double size : {0.1, 1.0, 10.0}) {
    const Chain chain = scaled(test::arms::industrial(), size);
    const Solver solver(chain);
    const Eigen::Isometry3d T = T_base_tip(chain, stretched());
    EXPECT_EQ(checked(chain, solver, moved(T, -kMillimetre * outward())).configurations.cols(), 4);
    EXPECT_EQ(checked(chain, solver, moved(T, kMillimetre * outward())).reason,
              NoSolution::OutOfReach);
  }
}

/// No closed form says it, but descents of which none gets there.
TEST(OutOfReach, AMillimetreDecidesForACalibratedArm) {
  std::mt19937_64 generator(kSeed);
  const Chain chain = test::perturbed(test::arms::industrial(), 1e-5, generator);
  ASSERT_FALSE(find_closed_form(chain).form.value().exact());
  const Solver solver(chain);
  const Eigen::Isometry3d T = T_base_tip(chain, stretched());
  EXPECT_GE(checked(chain, solver, moved(T, -kMillimetre * outward())).configurations.cols(), 2);
  EXPECT_EQ(checked(chain, solver, moved(T, kMillimetre * outward())).configurations.cols(), 0);
}

/// Three joints that place a point, the upper arm `kAside_m` beside the first axis: what the arm
/// reaches is less than the sum of its links, and only descents can tell.
constexpr double kAside_m = 0.3, kLink_m = 0.8;

Chain placing(double size) {
  kinematics::ChainParts parts = test::parts_of(
      test::screw_arm({{{0, 0, 0}, kZ}, {{0, kAside_m, 0}, kY}, {{kLink_m, kAside_m, 0}, kY}},
                      {2 * kLink_m, kAside_m, 0}));
  parts.task_axes.matters = {true, true, true, false, false, false};
  return scaled(Chain(std::move(parts)), size);
}

TEST(OutOfReach, AHundredthDecidesWithoutAClosedForm) {
  for (const double size : {1e-3, 1.0}) {
    const Chain chain = placing(size);
    const Solver solver(chain);
    ASSERT_EQ(solver.closed_form(), nullptr);
    Eigen::VectorXd q(3);
    q << 0.4, -0.6, 0;
    const Eigen::Isometry3d T = T_base_tip(chain, q);
    const Eigen::Vector3d by =
        Eigen::AngleAxisd(0.4, kZ) * (Eigen::AngleAxisd(-0.6, kY) * kX) * (0.01 * size);
    EXPECT_TRUE(holds(chain, checked(chain, solver, T), q, 0.01)) << size;
    // Two elbows, from either side of the first axis.
    EXPECT_EQ(checked(chain, solver, moved(T, -by)).configurations.cols(), 4) << size;
    EXPECT_EQ(checked(chain, solver, moved(T, by)).reason, NoSolution::OutOfReach) << size;
  }
}

/// A step of a descent that only quarters the error is not its last where a millionth of a metre is
/// little of the arm.
TEST(OutOfReach, AStraightArmOfManyMetresIsReached) {
  for (const double size : {5.0, 30.0}) {
    const Chain chain = placing(size);
    const Solver solver(chain);
    Eigen::VectorXd q(3);
    for (const double lift : {-0.6, 0.2, 1.1}) {
      q << 0.4, lift, 0;
      EXPECT_TRUE(holds(chain, checked(chain, solver, T_base_tip(chain, q)), q, 0.01))
          << size << " lifted by " << lift;
    }
  }
}

TEST(OutOfReach, AMillimetreInsideTheHoleOfAPlanarArm) {
  const Chain chain = test::PlanarArm{.lengths_m = {1, 0.5}, .yaw = false}.chain();
  const Solver solver(chain);
  EXPECT_EQ(checked(chain, solver, test::planar_pose(0.499, 0, 0)).reason, NoSolution::OutOfReach);
  EXPECT_EQ(checked(chain, solver, test::planar_pose(0.5, 0, 0)).configurations.cols(), 1);
  EXPECT_EQ(checked(chain, solver, test::planar_pose(0.501, 0, 0)).configurations.cols(), 2);
}

/// The slide of a crane: at the end of its stroke, and a millimetre beyond.
TEST(OutOfReach, AMillimetreBeyondTheStrokeIsOutsideLimits) {
  const Chain chain = test::screw_arm({{{0, 0, 0.4}, kZ},
                                       {{0, 0.15, 0.4}, kY},
                                       {{0, 0.15, 0.4}, kX, JointType::Prismatic, 0.4},
                                       {{0.5, 0.15, 0.4}, kX},
                                       {{0.5, 0.15, 0.4}, kY},
                                       {{0.5, 0.15, 0.4}, kX}},
                                      {0.6, 0.15, 0.4});
  const Solver solver(chain);
  Eigen::VectorXd q(6);
  q << 0.7, -0.3, 0.4, 0.5, 0.9, -0.2;
  EXPECT_TRUE(holds(chain, checked(chain, solver, T_base_tip(chain, q)), q));
  q[2] += kMillimetre;
  EXPECT_EQ(checked(chain, solver, T_base_tip(chain, q)).reason, NoSolution::Limits);
}

/// Arms of fewer than six joints reach a set of poses without volume; a millimetre leads off it.
TEST(OutOfReach, AMillimetreOffThePosesOfFewJoints) {
  std::mt19937_64 generator(kSeed);
  for (int joints = 1; joints <= 5; ++joints) {
    const Chain chain = test::random_chain({.joints = joints}, generator);
    const Solver solver(chain);
    Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(joints, -0.8, 1.1);
    const Eigen::Isometry3d T = T_base_tip(chain, q);
    EXPECT_TRUE(holds(chain, checked(chain, solver, T), q)) << joints;
    // Across everything that the joints can do.
    std::vector<TaskError> motions;
    const auto across_all = [&](TaskError error) {
      for (const TaskError& motion : motions)
        error -= error.dot(motion) * motion;
      return TaskError(error.normalized());
    };
    for (int j = 0; j < joints; ++j) {
      Eigen::VectorXd beside = q;
      beside[j] += 1e-5;
      motions.push_back(across_all(task_error(T_base_tip(chain, beside), T, {})));
    }
    const TaskError across = kMillimetre * across_all(TaskError::Ones());
    Eigen::Isometry3d off = moved(T, across.head<3>());
    off.linear() =
        Eigen::AngleAxisd(across.tail<3>().norm(), across.tail<3>().normalized()) * T.linear();
    EXPECT_EQ(checked(chain, solver, off).reason, NoSolution::OutOfReach) << joints;
  }
}

}  // namespace
}  // namespace kinship::inverse::out_of_reach_test
