#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/moveit/yaml_value.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::moveit {

/// Poses of a planning scene's frames in the task frame: the robot's links at its start, the
/// planning frame, and the scene's own frames.
class Frames {
 public:
  /// The planning frame is that of the URDF's root link, unless a virtual joint of the start moves
  /// that; so are `world`, the virtual joint's frame and a frame without name.
  /// \param T_task_base  empty: the task frame is the planning frame.
  /// \param start        dof, joint units: sets the poses of moving links.
  /// \param scene        moveit_msgs/PlanningScene
  /// \param request      moveit_msgs/MotionPlanRequest
  /// \throws Failure(InvalidInput) if several joints move the root link
  Frames(const kinematics::Chain& chain, const std::optional<Eigen::Isometry3d>& T_task_base,
         const Eigen::VectorXd& start, const YamlValue& scene, const YamlValue& request);

  /// \param name  a scalar, or missing.
  /// \throws Failure(InvalidInput) for an unknown frame.
  Eigen::Isometry3d T_task_frame(const YamlValue& name) const;

  /// The frame of a message's header.
  Eigen::Isometry3d T_task_header(const YamlValue& message) const {
    return T_task_frame(message["header"]["frame_id"]);
  }

  const Eigen::Isometry3d& T_task_base() const noexcept { return T_task_base_; }

  /// \throws Failure(InvalidInput) at `name` if the robot has no such link.
  Eigen::Isometry3d T_task_link(const YamlValue& name) const;

  /// The transfer frame in a link that the robot's last joint moves.
  /// \throws Failure(InvalidInput) at `name` if it is no such link.
  Eigen::Isometry3d T_link_transfer(const YamlValue& name) const;

 private:
  /// A frame by its name; empty if unknown.
  std::optional<Eigen::Isometry3d> find(const std::string& name, int depth) const;

  struct CarriedFrame {
    std::string parent;
    Eigen::Isometry3d T_parent_frame;
  };

  const kinematics::Chain& chain_;
  std::vector<Eigen::Isometry3d> T_base_links_;
  Eigen::Isometry3d T_task_base_;
  Eigen::Isometry3d T_task_planning_;
  std::string planning_frame_;  // its other name; empty: none is known
  std::map<std::string, CarriedFrame> carried_;
};

}  // namespace kinship::moveit
