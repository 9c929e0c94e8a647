#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "robots/collision/collision_world.hpp"

/// A planar arm for tests: joints about z, links of length 0.5 m along x, so that a configuration
/// is easy to picture. A link's frame stands at its far end.
namespace kinship::collision::test_support {

inline constexpr double kLink_m = 0.5, kRadius_m = 0.05;

inline Eigen::Isometry3d shift(double x, double y = 0, double z = 0) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

/// Links "base", "link1" ... "linkN" in a row; the base link is shapeless unless given a shape.
inline kinematics::Chain toy_chain(int joints) {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.links.push_back({"base", -1, Eigen::Isometry3d::Identity(), -1});
  for (int i = 0; i < joints; ++i) {
    kinematics::Joint joint;
    joint.name = "joint" + std::to_string(i + 1);
    joint.T_previous_joint = shift(i == 0 ? 0 : kLink_m);
    joint.lower = -M_PI;
    joint.upper = M_PI;
    parts.joints.push_back(joint);
    parts.links.push_back({"link" + std::to_string(i + 1), i, shift(kLink_m), i});
  }
  parts.tip_link = parts.links.back().name;
  return kinematics::Chain(parts);
}

/// A capsule along the middle of each moving link, which leaves the joints bare so that folding,
/// not bending, makes links touch.
inline geometry::RobotShapes toy_shapes(int joints) {
  geometry::RobotShapes shapes;
  Eigen::Isometry3d T = shift(-kLink_m / 2);
  T.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (int i = 0; i < joints; ++i)
    shapes.shapes.push_back({i + 1, CapsuleShape{kRadius_m, kLink_m - 0.2}, T});
  return shapes;
}

inline SceneObject box_at(const std::string& name, double x, double y, double size_m = 0.1) {
  return {name, BoxShape{Eigen::Vector3d::Constant(size_m)}, shift(x, y)};
}

inline Eigen::VectorXd angles(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(),
                                           static_cast<Eigen::Index>(values.size()));
}

}  // namespace kinship::collision::test_support
