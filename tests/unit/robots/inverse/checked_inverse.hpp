#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/chain_parts.hpp"

namespace kinship::inverse {

/// All solutions there are, those closer than 0.01 taken as one.
inline constexpr InverseOptions kAllSolutions{.max_solutions = 0, .min_distance = 0.01};

/// How far off its pose a configuration is: farther off in m or rad, by forward kinematics of the
/// chain alone.
inline double pose_gap(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip,
                       const Eigen::VectorXd& q) {
  const Eigen::Isometry3d T_wanted = T_base_tip * chain.T_tip_transfer();
  const Eigen::Isometry3d T = kinematics::T_base_transfer(chain, q);
  const Eigen::Quaterniond turn(T_wanted.linear() * T.linear().transpose());
  return std::max((T_wanted.translation() - T.translation()).norm(),
                  2 * std::atan2(turn.vec().norm(), std::abs(turn.w())));
}

/// Largest difference of two configurations by joint, but for whole turns of turning joints.
inline double turned_difference(const kinematics::Chain& chain, const Eigen::VectorXd& a,
                                const Eigen::VectorXd& b) {
  double largest = 0;
  for (Eigen::Index j = 0; j < a.size(); ++j) {
    const bool slides =
        chain.joints()[static_cast<std::size_t>(j)].type == kinematics::JointType::Prismatic;
    const double difference = a[j] - b[j];
    largest = std::max(
        largest, std::abs(slides ? difference : std::remainder(difference, 2 * std::numbers::pi)));
  }
  return largest;
}

/// Whether a configuration is among solutions, but for whole turns.
inline bool holds(const kinematics::Chain& chain, const InverseSolutions& solutions,
                  const Eigen::VectorXd& q, double tolerance = 1e-4) {
  for (const auto& solution : solutions.configurations.colwise())
    if (turned_difference(chain, solution, q) < tolerance)
      return true;
  return false;
}

/// What a solver answers, and what must hold of every answer: each solution reaches the pose within
/// 1e-6 m and 1e-6 rad, lies within limits and is no copy of another; there is a reason for none.
inline InverseSolutions checked(const kinematics::Chain& chain, const Solver& solver,
                                const Eigen::Isometry3d& T_base_tip,
                                const InverseOptions& options = kAllSolutions) {
  InverseSolutions found = solver.solve(T_base_tip, options);
  const Eigen::MatrixXd& all = found.configurations;
  EXPECT_EQ(all.cols() == 0, found.reason != NoSolution::None);
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    EXPECT_TRUE(chain.within_limits(all.col(i))) << all.col(i).transpose();
    EXPECT_TRUE(chain.task_axes().all()
                    ? pose_gap(chain, T_base_tip, all.col(i)) < 1.001e-6
                    : reaches(chain, T_base_tip * chain.T_tip_transfer(), all.col(i)))
        << all.col(i).transpose();
    for (Eigen::Index k = 0; k < i; ++k)
      EXPECT_GT(turned_difference(chain, all.col(i), all.col(k)), 1e-5)
          << all.col(i).transpose() << " and " << all.col(k).transpose();
  }
  return found;
}

/// The same arm with other limits.
inline kinematics::Chain with_limits(const kinematics::Chain& chain, const Eigen::VectorXd& lower,
                                     const Eigen::VectorXd& upper) {
  kinematics::ChainParts parts = test::parts_of(chain);
  for (std::size_t j = 0; j < parts.joints.size(); ++j) {
    parts.joints[j].lower = lower[static_cast<Eigen::Index>(j)];
    parts.joints[j].upper = upper[static_cast<Eigen::Index>(j)];
  }
  return kinematics::Chain(std::move(parts));
}

/// The same with the same limits for every joint.
inline kinematics::Chain with_limits(const kinematics::Chain& chain, double lower, double upper) {
  return with_limits(chain, Eigen::VectorXd::Constant(chain.dof(), lower),
                     Eigen::VectorXd::Constant(chain.dof(), upper));
}

/// The same arm, every length of it times a factor.
inline kinematics::Chain scaled(const kinematics::Chain& chain, double factor) {
  kinematics::ChainParts parts = test::parts_of(chain);
  for (kinematics::Joint& joint : parts.joints) {
    joint.T_previous_joint.translation() *= factor;
    if (joint.type == kinematics::JointType::Prismatic) {
      joint.lower *= factor;
      joint.upper *= factor;
    }
  }
  parts.T_last_tip.translation() *= factor;
  parts.T_tip_transfer.translation() *= factor;
  return kinematics::Chain(std::move(parts));
}

/// What is special about tests::arms::industrial: the reach of its wrist, measured from joint 2.
struct IndustrialArm {
  static constexpr double kShoulder_m = 0.35;  ///< joint 2 off the axis of joint 1
  static constexpr double kUpper_m = 1, kFore_x_m = 1.45, kFore_z_m = 0.15;

  static double fore_m() { return std::hypot(kFore_x_m, kFore_z_m); }
  /// Joint 3 where the wrist is in line with joints 2 and 3, and farthest from joint 2.
  static double straight() { return -std::atan2(kFore_x_m, kFore_z_m); }
  static double folded() { return straight() + std::numbers::pi; }
};

}  // namespace kinship::inverse
