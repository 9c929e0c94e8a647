#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// Bounds on the motion of a robot's bodies on a straight line between two configurations.
///
/// Joint by joint: a prismatic joint moves a point by its displacement, a revolute one by at most
/// its turn times the point's distance from the joint's axis. That distance is bounded by the
/// lengths of the links between (farthest_m), or closer by its values at both ends of the line and
/// the body's motion by the joints between axis and body (bound). Neither needs limits.
/// Source: Schwarzer, Saha and Latombe, Adaptive Dynamic Collision Checking for Single and Multiple
/// Articulated Robots in Complex Environments, IEEE Transactions on Robotics 21 (2005), section IV;
/// the distances at both ends are ours.
class MotionBounds {
 public:
  MotionBounds(const kinematics::Chain& chain, const std::vector<Body>& bodies);

  /// A bound of the way of any body's points on a line, m: coarser than bound(), without forward
  /// kinematics.
  /// \param from, to  dof, joint units: the ends of the line
  /// \return infinity where the numbers are too large for a bound
  double farthest_m(const Eigen::Ref<const Eigen::VectorXd>& from,
                    const Eigen::Ref<const Eigen::VectorXd>& to) const;

  /// Largest distances of a body's points from the axes of the joints that move it, at one
  /// configuration, m; 0 for prismatic joints.
  /// \param T_base_joints  poses of the joints' moving frames there, one per moving joint
  /// \param reach_m        out: one per moving joint; written for the body's own joint and those
  ///                       before it
  void measure(std::size_t body, const std::vector<Eigen::Isometry3d>& T_base_joints,
               Eigen::Ref<Eigen::VectorXd> reach_m) const;

  /// Bounds of the way of a body's points between two configurations, in the frame of every joint
  /// before it, m. A part of the way has at most the same part of the bound, which therefore limits
  /// the speed too.
  /// \param change    dof, joint units: of the joints from one end to the other
  /// \param from_m, to_m  of measure() at both ends
  /// \param motion_m  out: moving joints + 1; [0]: in the base's frame, [k]: in the moving frame of
  ///                  the k-th joint, counted from 1; written for the body's own joint and those
  ///                  before it
  void bound(std::size_t body, const Eigen::Ref<const Eigen::VectorXd>& change,
             const Eigen::Ref<const Eigen::VectorXd>& from_m,
             const Eigen::Ref<const Eigen::VectorXd>& to_m,
             Eigen::Ref<Eigen::VectorXd> motion_m) const;

 private:
  struct Hull {
    int joint = -1;
    Eigen::Matrix3Xd corners;  // 3 x 1, 2 or 8, in the joint's moving frame
    double radius_m = 0;       // the body lies within it of the corners' hull
  };

  /// A moving joint.
  struct Step {
    Eigen::Vector3d axis;  // in its frame
    bool slides = false;
    int before = -1;        // the moving joint before it
    int source = 0;         // of `change`: itself, or the joint it follows,
    double multiplier = 1;  // so many times
    double offset = 0;      // and so much more, rad or m
    // Of its origin where it does not slide, from the axis and the origin of the joint before.
    double origin_across_m = 0, origin_reach_m = 0;
    double across_m = 0, reach_m = 0;  // of its bodies, from its axis and from its origin
  };

  std::vector<Step> steps_;
  std::vector<Hull> hulls_;  // one a body
};

}  // namespace kinship::collision
