#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/link_mesh.hpp"
#include "proto/types/mesh_solids.hpp"
#include "proto/types/task_axes.hpp"

namespace kinship {

/// Description of a robot that a client registers.
struct RobotDescription {
  std::string label;  ///< for people; unique in a store
  std::string urdf;   ///< URDF text, at most kMaxUrdfBytes
  std::string base_link;
  std::string tip_link;
  Eigen::Isometry3d T_tip_transfer = Eigen::Isometry3d::Identity();
  TaskAxes task_axes;
  std::map<std::string, double> held_joints;  ///< joints off the chain, joint units
  std::vector<std::pair<std::string, std::string>> never_colliding;  ///< pairs of link names
  MeshSolids mesh_solids = {};        ///< for a server, which cannot read the URDF's meshes
  std::vector<LinkMesh> meshes = {};  ///< of the URDF, by their contents
  /// Some contents of `meshes`, in a request only: neither stored with it nor part of its JSON.
  std::vector<MeshContent> contents = {};
};

}  // namespace kinship
