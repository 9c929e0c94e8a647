#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "proto/types/scene.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::page {

/// A capsule of a drawn robot: the points within `radius_m` of a segment, in the task frame.
struct Bone {
  Eigen::Vector3d from, to;
  double radius_m = 0;
};

/// A robot in one configuration as capsules around its collision shapes: capsules and spheres as
/// they are, a cylinder or box as a capsule along its longest side.
/// \param q  dof, joint units.
std::vector<Bone> bones_of(const models::LoadedRobot& robot, const Eigen::Isometry3d& T_task_base,
                           const Eigen::Ref<const Eigen::VectorXd>& q);

/// The attached objects of the robot at one configuration, without meshes.
/// \param q  dof, joint units.
/// \throws std::invalid_argument if an object is attached to a link that the chain does not have.
std::vector<SceneObject> held_objects(const models::LoadedRobot& robot,
                                      const std::vector<AttachedObject>& attached,
                                      const Eigen::Isometry3d& T_task_base,
                                      const Eigen::Ref<const Eigen::VectorXd>& q);

/// The objects of a scene that view.js draws: its solids, and boxes around its meshes and point
/// clouds.
/// \param scene  read (models::SceneMeshes); objects without triangles or voxels are left out.
std::vector<SceneObject> drawn_objects(const Scene& scene);

}  // namespace kinship::page
