#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>

#include "proto/types/robot_description.hpp"

/// An arm with links beside its chain that move with it, for tests: as large palletising arms have.
namespace kinship::test {

/// base -swing- turret -lift- lower -bend- upper -twist- hand. Beside these:
/// turret -rod_joint- rod, which stays parallel to the lower arm; lower -level_joint- level, which
/// keeps its orientation, so that its rear end stays on the rod's upper end; lower -weight_joint-
/// weight, which follows the bend; weight -piston_joint- piston -cap_mount- cap, which follows the
/// weight; base -shutter_joint- shutter.
inline constexpr const char* kParallelogramArm = R"(<robot name="parallelogram">
  <link name="base"><collision><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.15" length="0.2"/></geometry></collision></link>
  <link name="turret"><collision><origin xyz="-0.05 0 0.1"/><geometry><box size="0.3 0.2 0.2"/></geometry></collision></link>
  <link name="lower"><collision><origin xyz="0 0.1 0.4"/><geometry><box size="0.1 0.1 0.7"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0.35 0 0"/><geometry><box size="0.6 0.08 0.08"/></geometry></collision></link>
  <link name="hand"><collision><origin xyz="0.05 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="rod"><collision><origin xyz="0 0 0.4"/><geometry><cylinder radius="0.02" length="0.8"/></geometry></collision></link>
  <link name="level"><collision><origin xyz="-0.15 -0.15 0"/><geometry><box size="0.36 0.03 0.06"/></geometry></collision></link>
  <link name="weight"><collision><origin xyz="-0.2 0 0"/><geometry><box size="0.2 0.06 0.1"/></geometry></collision></link>
  <link name="piston"><collision><origin xyz="-0.4 0 0"/><geometry><cylinder radius="0.02" length="0.1"/></geometry></collision></link>
  <link name="cap"/>
  <link name="shutter"><collision><origin xyz="0 0 0.05"/><geometry><sphere radius="0.04"/></geometry></collision></link>
  <joint name="swing" type="continuous"><parent link="base"/><child link="turret"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/></joint>
  <joint name="lift" type="revolute"><parent link="turret"/><child link="lower"/><origin xyz="0.1 0 0.2"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1.2" effort="1" velocity="1"/></joint>
  <joint name="bend" type="revolute"><parent link="lower"/><child link="upper"/><origin xyz="0 0 0.8"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="twist" type="revolute"><parent link="upper"/><child link="hand"/><origin xyz="0.7 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="rod_joint" type="continuous"><parent link="turret"/><child link="rod"/><origin xyz="-0.2 -0.15 0.2"/><axis xyz="0 1 0"/>
    <mimic joint="lift"/></joint>
  <joint name="level_joint" type="continuous"><parent link="lower"/><child link="level"/><origin xyz="0 0 0.8"/><axis xyz="0 1 0"/>
    <mimic joint="lift" multiplier="-1"/></joint>
  <joint name="weight_joint" type="revolute"><parent link="lower"/><child link="weight"/><origin xyz="-0.1 0 0.1" rpy="0.1 0 0"/><axis xyz="0 2 0"/>
    <limit lower="-0.1" upper="0.1" effort="1" velocity="1"/><mimic joint="bend" multiplier="0.5" offset="0.3"/></joint>
  <joint name="piston_joint" type="prismatic"><parent link="weight"/><child link="piston"/><origin xyz="0 0 0.05"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="weight_joint" multiplier="-0.2" offset="0.05"/></joint>
  <joint name="cap_mount" type="fixed"><parent link="piston"/><child link="cap"/><origin xyz="-0.45 0 0"/></joint>
  <joint name="shutter_joint" type="prismatic"><parent link="base"/><child link="shutter"/><origin xyz="-0.5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="lift" multiplier="0.6" offset="0.6"/></joint>
</robot>)";

inline RobotDescription parallelogram_description() {
  RobotDescription description;
  description.label = "parallelogram";
  description.urdf = kParallelogramArm;
  description.base_link = "base";
  description.tip_link = "hand";
  return description;
}

/// Where the links beside the chain are in the base link, by what the drawing says and no chain.
inline std::map<std::string, Eigen::Isometry3d> followers_of_parallelogram(
    const Eigen::Vector4d& q) {
  using Eigen::AngleAxisd, Eigen::Translation3d;
  const auto about_y = [](double angle) { return AngleAxisd(angle, Eigen::Vector3d::UnitY()); };
  const Eigen::Isometry3d turret =
      Translation3d(0, 0, 0.3) * AngleAxisd(q[0], Eigen::Vector3d::UnitZ());
  const Eigen::Isometry3d lower = turret * Translation3d(0.1, 0, 0.2) * about_y(q[1]);
  std::map<std::string, Eigen::Isometry3d> poses;
  poses["rod"] = turret * Translation3d(-0.2, -0.15, 0.2) * about_y(q[1]);
  poses["level"] = lower * Translation3d(0, 0, 0.8) * about_y(-q[1]);
  const double weight = 0.5 * q[2] + 0.3;
  poses["weight"] = lower * Translation3d(-0.1, 0, 0.1) *
                    AngleAxisd(0.1, Eigen::Vector3d::UnitX()) * about_y(weight);
  poses["piston"] = poses["weight"] * Translation3d(-0.2 * weight + 0.05, 0, 0.05);
  poses["cap"] = poses["piston"] * Translation3d(-0.45, 0, 0);
  poses["shutter"] = Eigen::Isometry3d(Translation3d(-0.5, 0, 0.6 * q[1] + 0.6));
  return poses;
}

}  // namespace kinship::test
