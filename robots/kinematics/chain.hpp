#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/task_axes.hpp"

namespace kinship::kinematics {

enum class JointType { Revolute, Continuous, Prismatic };

/// A moving joint of a chain. Fixed joints are folded into `T_previous_joint`.
struct Joint {
  std::string name;
  JointType type = JointType::Revolute;
  /// Pose of this joint's frame at q = 0 in the moving frame of the joint before it (the base
  /// link for the first).
  Eigen::Isometry3d T_previous_joint = Eigen::Isometry3d::Identity();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit vector in this joint's frame
  double lower = 0;                                 ///< rad or m; -pi for continuous joints
  double upper = 0;                                 ///< rad or m; +pi for continuous joints
};

/// A joint beside the chain that follows one of its joints: a parallelogram's, a counterweight's.
/// Its value is multiplier * q[source] + offset, regardless of its own limits.
struct MimicJoint {
  /// Its frame in the moving frame of `before`. The Chain derives the limits from the source's.
  Joint joint;
  int before = -1;  ///< index of the moving joint before it, below its own; -1: the base link
  int source = 0;   ///< index of the joint of the chain that it follows
  double multiplier = 1;
  double offset = 0;  ///< rad or m
};

/// A link of the URDF and the joint that moves it; joints off the chain that follow none of its
/// joints are held.
struct ChainLink {
  std::string name;
  int joint = -1;  ///< index of the last moving joint before it; -1: fixed to the base link
  Eigen::Isometry3d T_joint_link = Eigen::Isometry3d::Identity();  ///< in that joint's moving frame
  /// Index of the parent link in Chain::links(), below this link's own; -1: the URDF's root link.
  int parent = -1;
};

/// The parts of a Chain.
struct ChainParts {
  std::string base_link, tip_link;
  std::vector<Joint> joints;  ///< from base to tip
  Eigen::Isometry3d T_last_tip =
      Eigen::Isometry3d::Identity();  ///< tip link in the last moving frame
  Eigen::Isometry3d T_tip_transfer = Eigen::Isometry3d::Identity();
  TaskAxes task_axes;
  std::vector<ChainLink> links;         ///< every link of the URDF
  std::vector<MimicJoint> mimics = {};  ///< each after the one before it
};

/// The first fault that keeps parts from being a Chain, as text with its value and the limit.
std::optional<std::string> validate(const ChainParts& parts);

/// A kinematic chain from a base link to a tip link with a transfer frame: the model of a robot.
///
/// Its moving joints are counted from the base to the tip, and after these its mimic joints.
///
/// Invariant: 1 to kMaxDof joints, unit axes, finite limits with lower < upper, rigid transforms,
/// every coordinate, limit and value of a mimic joint at most kMaxPlacement_m, at least one task
/// axis, links after their parents; a joint that follows a continuous one does so by full turns.
class Chain {
 public:
  /// The limits of continuous joints are set to -pi and pi.
  /// \throws std::invalid_argument with validate() if the invariant does not hold.
  explicit Chain(ChainParts parts);

  /// Its parts, to make a similar chain.
  const ChainParts& parts() const noexcept { return parts_; }
  Eigen::Index dof() const noexcept { return static_cast<Eigen::Index>(parts_.joints.size()); }
  const std::vector<Joint>& joints() const noexcept { return parts_.joints; }
  const std::vector<MimicJoint>& mimics() const noexcept { return parts_.mimics; }
  const std::vector<ChainLink>& links() const noexcept { return parts_.links; }
  const std::string& base_link() const noexcept { return parts_.base_link; }
  const std::string& tip_link() const noexcept { return parts_.tip_link; }
  const Eigen::Isometry3d& T_last_tip() const noexcept { return parts_.T_last_tip; }
  const Eigen::Isometry3d& T_tip_transfer() const noexcept { return parts_.T_tip_transfer; }
  const TaskAxes& task_axes() const noexcept { return parts_.task_axes; }
  const Eigen::VectorXd& lower() const noexcept { return lower_; }  ///< dof
  const Eigen::VectorXd& upper() const noexcept { return upper_; }  ///< dof

  /// Whether every joint lies within its limits; continuous joints always do, NaN never.
  /// \throws std::invalid_argument if q.size() != dof().
  bool within_limits(const Eigen::Ref<const Eigen::VectorXd>& q, double tolerance = 0) const;

  int moving_joints() const noexcept;  ///< dof() and the mimic joints
  /// \param joint  of the moving ones, as in the next functions.
  const Joint& moving_joint(int joint) const noexcept;
  int joint_before(int joint) const noexcept;  ///< -1: the base link
  /// The last moving joint that moves the links of both joints; -1: none does.
  int joint_before_both(int a, int b) const noexcept;
  /// The last joint of the chain whose value moves the links of this one.
  int last_source(int joint) const noexcept;

  /// Index into links(), or -1.
  int find_link(std::string_view name) const noexcept;

  /// Identity of the robot: SHA-256 of joint types, axes, origins, limits, transfer frame and task
  /// axes, each number rounded to 1e-9 (m, rad, 1) so that machines whose libraries differ in the
  /// last bits agree. Names, labels, geometry and mimic joints do not count.
  Digest digest() const;

 private:
  ChainParts parts_;
  Eigen::VectorXd lower_, upper_;
};

}  // namespace kinship::kinematics
