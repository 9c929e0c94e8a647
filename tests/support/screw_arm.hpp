#pragma once

#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "robots/kinematics/chain.hpp"
#include "tests/support/chain_parts.hpp"

namespace kinship::test {

/// A joint of an arm that is given by its lines while every joint stands at 0.
struct Line {
  Eigen::Vector3d point;      ///< m, in the base link
  Eigen::Vector3d direction;  ///< of any length
  kinematics::JointType type = kinematics::JointType::Revolute;
  double limit = std::numbers::pi;  ///< both ways, joint units
};

/// The chain whose joints turn about lines. Every frame stands upright at 0.
/// \param p_base_tip  of the tip link at 0, m.
inline kinematics::Chain screw_arm(const std::vector<Line>& lines,
                                   const Eigen::Vector3d& p_base_tip) {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "tip";
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const Line& line : lines) {
    kinematics::Joint joint;
    joint.name = "joint" + std::to_string(parts.joints.size() + 1);
    joint.type = line.type;
    joint.T_previous_joint.translation() = line.point - last;
    joint.axis = line.direction.normalized();
    joint.lower = -line.limit;
    joint.upper = line.limit;
    parts.joints.push_back(joint);
    last = line.point;
  }
  parts.T_last_tip.translation() = p_base_tip - last;
  return kinematics::Chain(std::move(parts));
}

/// The same arm, moved by another unit: every origin off by normally distributed numbers of
/// standard deviation sigma, m and rad.
inline kinematics::Chain perturbed(const kinematics::Chain& chain, double sigma,
                                   std::mt19937_64& generator) {
  std::normal_distribution<double> off(0, sigma);
  kinematics::ChainParts parts = parts_of(chain);
  for (kinematics::Joint& joint : parts.joints) {
    const Eigen::Vector3d shift(off(generator), off(generator), off(generator));
    const Eigen::Vector3d turn(off(generator), off(generator), off(generator));
    joint.T_previous_joint.translation() += shift;
    joint.T_previous_joint.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  return kinematics::Chain(std::move(parts));
}

/// Arms that are in none of the model folders, by the family that their solution belongs to.
namespace arms {

inline const Eigen::Vector3d kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// As many industrial robots: shoulder offset, parallel shoulder and elbow, spherical wrist.
inline kinematics::Chain industrial() {
  return screw_arm({{{0, 0, 0.4}, kZ},
                    {{0.35, 0, 0.8}, kY},
                    {{0.35, 0, 1.8}, kY},
                    {{0.5, 0, 1.95}, kX},
                    {{1.8, 0, 1.95}, kY},
                    {{2, 0, 1.95}, kX}},
                   {2.2, 0, 1.95});
}

/// A wrist whose axes stand at 60 degrees to each other.
inline kinematics::Chain hollow_wrist() {
  return screw_arm({{{0, 0, 0.4}, kZ},
                    {{0.35, 0, 0.8}, kY},
                    {{0.35, 0, 1.8}, kY},
                    {{0.5, 0, 1.95}, kX},
                    {{1.8, 0, 1.95}, {1, 0, std::numbers::sqrt3}},
                    {{1.8, 0, 1.95}, kX}},
                   {2.2, 0, 1.95});
}

/// Second and third axis meet, the first does not.
inline kinematics::Chain late_shoulder() {
  return screw_arm({{{0, 0, 0.4}, kZ},
                    {{0.35, 0, 0.8}, kY},
                    {{0.35, 0, 0.8}, kX},
                    {{1.2, 0, 1.95}, kX},
                    {{1.2, 0, 1.95}, kY},
                    {{1.2, 0, 1.95}, kX}},
                   {1.3, 0, 1.95});
}

/// First two axes parallel, as those of an arm that works in the horizontal plane.
inline kinematics::Chain horizontal() {
  return screw_arm({{{0, 0, 0.4}, kZ},
                    {{0.5, 0, 0.8}, kZ},
                    {{0.9, 0, 0.8}, kY},
                    {{1.2, 0, 1.3}, kX},
                    {{1.2, 0, 1.3}, kY},
                    {{1.2, 0, 1.3}, kX}},
                   {1.3, 0, 1.95});
}

/// A spherical wrist mounted as a shoulder.
inline kinematics::Chain spherical_shoulder() {
  return screw_arm({{{0, 0, 0.3}, kZ},
                    {{0, 0, 0.3}, kY},
                    {{0, 0, 0.3}, kZ},
                    {{0.02, 0.15, 0.7}, kY},
                    {{0.45, 0.15, 0.7}, kY},
                    {{0.45, 0, 0.7}, kZ}},
                   {0.5, 0.1, 0.5});
}

/// Axes 3, 4 and 5 parallel; 1 and 2 meet.
inline kinematics::Chain parallel_forearm() {
  return screw_arm({{{0, 0, 0.3}, kZ},
                    {{0, 0, 0.3}, kY},
                    {{0, 0.2, 0.3}, kX},
                    {{0, 0.2, 0.8}, kX},
                    {{0.1, 0.2, 1.3}, -kX},
                    {{0.15, 0.25, 1.3}, kZ}},
                   {0.2, 0.3, 1.5});
}

/// An arm with three parallel axes on a track of 1.2 m.
inline kinematics::Chain on_track() {
  return screw_arm({{{0, 0, 0}, kX, kinematics::JointType::Prismatic, 0.6},
                    {{0, 0, 0.3}, kZ},
                    {{0, 0.1, 0.3}, kY},
                    {{0.6, 0.1, 0.3}, kY},
                    {{1.1, 0.1, 0.3}, -kY},
                    {{1.1, 0.2, 0.3}, kZ},
                    {{1.1, 0.2, 0.2}, kY}},
                   {1.1, 0.3, 0.2});
}

/// No two neighbouring axes meet or are parallel.
inline kinematics::Chain general() {
  return screw_arm({{{0, 0, 0.15}, kZ},
                    {{0, 0.1, 0.28}, {0.3, 1, 0.2}},
                    {{0.2, 0.3, 0.4}, {1, 0.2, 0.1}},
                    {{0.1, -0.2, 0.7}, {0.1, 1, 0.6}},
                    {{0.2, 0, 0.9}, {1, -0.4, 1}},
                    {{0, 0.1, 1.01}, {0.3, 1, -0.5}}},
                   {0, 0, 1.2});
}

}  // namespace arms

}  // namespace kinship::test
