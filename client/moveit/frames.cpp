#include "client/moveit/frames.hpp"

#include "client/moveit/geometry_messages.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::moveit {
namespace {

constexpr int kMaxCarriedFrames = 100;  // one in another: ends what hangs from itself

std::string without_slash(std::string name) {
  if (name.starts_with('/'))
    name.erase(0, 1);
  return name;
}

/// sensor_msgs/MultiDOFJointState of where planning starts: of the request, else of the scene.
YamlValue virtual_joints(const YamlValue& scene, const YamlValue& request) {
  const YamlValue of_start = request["start_state"]["multi_dof_joint_state"];
  return of_start["transforms"].items().empty() ? scene["robot_state"]["multi_dof_joint_state"]
                                                : of_start;
}

/// Where a virtual joint puts the root link in the planning frame; identity if there is none.
Eigen::Isometry3d read_root_pose(const YamlValue& joints) {
  const std::vector<YamlValue> transforms = joints["transforms"].items();
  if (transforms.size() > 1)
    joints["transforms"].refuse(std::to_string(transforms.size()) +
                                " joints of several degrees of freedom; one, the virtual joint of "
                                "the robot's root, can be taken");
  return transforms.empty() ? Eigen::Isometry3d::Identity() : read_pose(transforms.front());
}

}  // namespace

Frames::Frames(const kinematics::Chain& chain, const std::optional<Eigen::Isometry3d>& T_task_base,
               const Eigen::VectorXd& start, const YamlValue& scene, const YamlValue& request)
    : chain_(chain), T_base_links_(kinematics::link_poses(chain, start)) {
  Eigen::Isometry3d T_base_root = Eigen::Isometry3d::Identity();
  for (std::size_t index = 0; index < chain.links().size(); ++index)
    if (chain.links()[index].parent < 0)
      T_base_root = T_base_links_[index];
  const YamlValue joints = virtual_joints(scene, request);
  const Eigen::Isometry3d T_root_planning = read_root_pose(joints).inverse();
  T_task_base_ = T_task_base.value_or((T_base_root * T_root_planning).inverse());
  T_task_planning_ = T_task_base_ * T_base_root * T_root_planning;
  planning_frame_ = without_slash(joints["header"]["frame_id"].text_or(""));
  for (const YamlValue& carried : scene["fixed_frame_transforms"].items())
    carried_[without_slash(carried["child_frame_id"].text())] = {
        .parent = without_slash(carried["header"]["frame_id"].text_or("")),
        .T_parent_frame = read_pose(carried["transform"])};
}

Eigen::Isometry3d Frames::T_task_frame(const YamlValue& name) const {
  const std::string wanted = without_slash(name.text_or(""));
  const auto pose = find(wanted, 0);
  if (!pose)
    name.refuse("frame '" + wanted +
                "' is not known: no link of the robot, and not among fixed_frame_transforms");
  return *pose;
}

Eigen::Isometry3d Frames::T_task_link(const YamlValue& name) const {
  const int link = chain_.find_link(name.text());
  if (link < 0)
    name.refuse("the robot has no link '" + name.text() + "'");
  return T_task_base_ * T_base_links_[static_cast<std::size_t>(link)];
}

Eigen::Isometry3d Frames::T_link_transfer(const YamlValue& name) const {
  const Eigen::Isometry3d T_link_task = T_task_link(name).inverse();
  const kinematics::ChainLink& link =
      chain_.links()[static_cast<std::size_t>(chain_.find_link(name.text()))];
  if (link.joint != chain_.dof() - 1)
    name.refuse("'" + name.text() + "' does not move with the tip link '" + chain_.tip_link() +
                "', whose pose is wanted");
  const auto tip = static_cast<std::size_t>(chain_.find_link(chain_.tip_link()));
  return T_link_task * T_task_base_ * T_base_links_[tip] * chain_.T_tip_transfer();
}

std::optional<Eigen::Isometry3d> Frames::find(const std::string& name, int depth) const {
  if (const int link = chain_.find_link(name); link >= 0)
    return T_task_base_ * T_base_links_[static_cast<std::size_t>(link)];
  if (const auto carried = carried_.find(name);
      carried != carried_.end() && depth < kMaxCarriedFrames) {
    const auto parent = find(carried->second.parent, depth + 1);
    if (parent)
      return *parent * carried->second.T_parent_frame;
    return std::nullopt;
  }
  if (name.empty() || name == "world" || name == planning_frame_)
    return T_task_planning_;
  return std::nullopt;
}

}  // namespace kinship::moveit
