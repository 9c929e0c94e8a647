#pragma once

#include <string>

#include "client/guided/plan_problem.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/urdf.hpp"

/// A small planar arm and a problem for it: from one side of a wall to the other.
namespace kinship::guided::test {

inline std::string joint_xml(const std::string& name, const std::string& parent,
                             const std::string& child, double x, const std::string& limits) {
  return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" +
         child + "'/><origin xyz='" + std::to_string(x) + " 0 0'/><axis xyz='0 0 1'/><limit " +
         limits + " effort='1' velocity='1'/></joint>";
}

inline std::string link_xml(const std::string& name, double length) {
  const std::string half = std::to_string(length / 2);
  return "<link name='" + name + "'><collision><origin xyz='" + half +
         " 0 0'/><geometry><box size='" + std::to_string(length) +
         " 0.04 0.04'/></geometry></collision></link>";
}

/// Four links of 0.3 m in the plane z = 0; the transfer frame is the end of the last.
/// \param lower,upper  limits of the first joint; the others go from -2.8 to 2.8.
inline RobotDescription planar_description(const std::string& lower = "-2.8",
                                           const std::string& upper = "2.8") {
  const std::string limits = "lower='-2.8' upper='2.8'";
  RobotDescription description;
  description.label = "planar";
  description.urdf =
      "<robot name='planar'><link name='base'/>" + link_xml("l1", 0.3) + link_xml("l2", 0.3) +
      link_xml("l3", 0.3) + link_xml("l4", 0.3) +
      joint_xml("j1", "base", "l1", 0, "lower='" + lower + "' upper='" + upper + "'") +
      joint_xml("j2", "l1", "l2", 0.3, limits) + joint_xml("j3", "l2", "l3", 0.3, limits) +
      joint_xml("j4", "l3", "l4", 0.3, limits) + "</robot>";
  description.base_link = "base";
  description.tip_link = "l4";
  description.T_tip_transfer.translation().x() = 0.3;
  description.task_axes = {{true, true, false, false, false, true}};
  return description;
}

inline PlannedRobot planar_robot(const std::string& lower = "-2.8",
                                 const std::string& upper = "2.8") {
  const RobotDescription description = planar_description(lower, upper);
  kinematics::Chain chain = kinematics::read_chain(description).value_or_throw();
  geometry::RobotShapes shapes =
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw();
  return {chain, shapes};
}

/// The straight line from start to goal goes through a wall in front of the arm.
inline Problem wall_problem() {
  Problem problem;
  problem.name = "wall";
  problem.start = Eigen::Vector4d(0.9, 0.2, 0.1, 0.1);
  problem.goal_configurations = Eigen::Vector4d(-0.9, -0.2, -0.1, -0.1);
  problem.scene.objects.push_back(
      {"wall", BoxShape{{0.6, 0.05, 0.2}}, Eigen::Isometry3d(Eigen::Translation3d(0.8, 0, 0))});
  problem.seed = 11;
  return problem;
}

}  // namespace kinship::guided::test
