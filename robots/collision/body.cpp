#include "robots/collision/body.hpp"

#include <algorithm>

#include "proto/types/failure.hpp"
#include "robots/geometry/fitted_shape.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::collision {
namespace {

constexpr std::size_t kBlocksOfACloud = 64;  // each an obstacle, so that most are far away

[[noreturn]] void refuse(const std::string& message) {
  throw Failure(ErrorCode::InvalidInput, message);
}

void require_finite(const Eigen::Isometry3d& T, const std::string& what) {
  if (!T.matrix().allFinite())
    refuse(what + ": pose is not finite");
}

Solid make_solid(const Shape& shape, const std::string& what,
                 const Eigen::Matrix3Xd* triangles = nullptr) {
  try {
    return Solid(shape, triangles);
  } catch (const Failure& failure) {
    throw Failure(failure.code(), what + ": " + failure.what());
  }
}

/// A solid and its pose in the frame that its object is given in.
struct PlacedSolid {
  Solid solid;
  Eigen::Isometry3d T_frame_solid;
};

PlacedSolid place_mesh(const Mesh& mesh, const Eigen::Isometry3d& T_frame_mesh,
                       const std::string& what) {
  const std::string named = what + ": mesh '" + mesh.file + "'";
  if (!mesh.triangles)
    refuse(named + " has not been read");
  const auto fitted = geometry::fit_mesh(*mesh.triangles);
  if (!fitted)
    refuse(named + ": " + fitted.error().message);
  return {make_solid(fitted->fitted.shape, named, fitted->triangles.get()),
          T_frame_mesh * fitted->fitted.T_points_shape};
}

const kinematics::ChainLink& link_at(const kinematics::Chain& chain, int link) {
  if (link < 0 || link >= static_cast<int>(chain.links().size()))
    refuse("link " + std::to_string(link) + " of a shape is not a link of the chain");
  return chain.links()[static_cast<std::size_t>(link)];
}

void require_link(const kinematics::Chain& chain, const std::string& name,
                  const std::string& what) {
  if (chain.find_link(name) < 0)
    refuse(what + ": no link named '" + name + "'");
}

Body make_attached(const kinematics::Chain& chain, const AttachedObject& object) {
  const std::string what = "attached object '" + object.name + "'";
  require_link(chain, object.link, what);
  for (const std::string& name : object.touch_links)
    require_link(chain, name, what);
  require_finite(object.T_link_object, what);
  const int index = chain.find_link(object.link);
  const kinematics::ChainLink& link = link_at(chain, index);
  const PlacedSolid placed =
      object.mesh ? place_mesh(*object.mesh, object.T_link_object, what)
                  : PlacedSolid{make_solid(object.shape, what), object.T_link_object};
  return {BodyKind::Attached,
          object.name,
          index,
          link.joint,
          link.T_joint_link * placed.T_frame_solid,
          placed.solid,
          object.touch_links};
}

std::string unknown_name(const std::string& first, const std::string& second,
                         const std::string& name) {
  return "allowed collision ('" + first + "', '" + second +
         "'): no link, object or attachment named '" + name + "'";
}

void require_known_names(const std::vector<Body>& bodies, const kinematics::Chain& chain,
                         const Surroundings& surroundings) {
  const auto known = [&](const std::string& name) {
    return chain.find_link(name) >= 0 ||
           std::any_of(bodies.begin(), bodies.end(),
                       [&](const Body& body) { return body.name == name; });
  };
  for (const auto& [first, second] : surroundings.allowed_collisions)
    for (const std::string& name : {first, second})
      if (!known(name))
        refuse(unknown_name(first, second, name));
}

}  // namespace

std::vector<Body> link_bodies(const kinematics::Chain& chain, const geometry::RobotShapes& shapes) {
  std::vector<Body> bodies;
  for (const geometry::LinkShape& shape : shapes.shapes) {
    const kinematics::ChainLink& link = link_at(chain, shape.link);
    const std::string what = "link '" + link.name + "'";
    require_finite(shape.T_link_shape, what);
    bodies.push_back({BodyKind::Link,
                      link.name,
                      shape.link,
                      link.joint,
                      link.T_joint_link * shape.T_link_shape,
                      make_solid(shape.shape, what, shape.triangles.get()),
                      {}});
  }
  return bodies;
}

void place_bodies(const kinematics::Chain& chain, const std::vector<Body>& bodies,
                  const Eigen::Ref<const Eigen::VectorXd>& q,
                  std::vector<Eigen::Isometry3d>& T_base_bodies) {
  const std::vector<Eigen::Isometry3d> T_base_joints = kinematics::joint_poses(chain, q);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].joint >= 0)
      T_base_bodies[i] =
          T_base_joints[static_cast<std::size_t>(bodies[i].joint)] * bodies[i].T_joint_body;
}

std::vector<Eigen::Isometry3d> standing_poses(const std::vector<Body>& bodies) {
  std::vector<Eigen::Isometry3d> poses;
  for (const Body& body : bodies)
    poses.push_back(body.T_joint_body);
  return poses;
}

void add_surroundings(const kinematics::Chain& chain, const Surroundings& surroundings,
                      std::vector<Body>& bodies) {
  for (const AttachedObject& object : surroundings.attached)
    bodies.push_back(make_attached(chain, object));

  require_finite(surroundings.T_task_base, "placement of the base in the task frame");
  const Eigen::Isometry3d T_base_task = surroundings.T_task_base.inverse(Eigen::Isometry);
  const auto add_obstacle = [&](const std::string& name, const Eigen::Isometry3d& T_task_solid,
                                const Solid& solid) {
    bodies.push_back({BodyKind::Obstacle, name, -1, -1, T_base_task * T_task_solid, solid, {}});
  };
  for (const SceneObject& object : surroundings.scene.objects) {
    const std::string what = "scene object '" + object.name + "'";
    require_finite(object.T_task_object, what);
    add_obstacle(object.name, object.T_task_object, make_solid(object.shape, what));
  }
  for (const SceneMesh& object : surroundings.scene.meshes) {
    const std::string what = "scene object '" + object.name + "'";
    require_finite(object.T_task_mesh, what);
    const PlacedSolid placed = place_mesh(object.mesh, object.T_task_mesh, what);
    add_obstacle(object.name, placed.T_frame_solid, placed.solid);
  }
  for (const SceneCloud& object : surroundings.scene.clouds) {
    const std::string what = "scene object '" + object.name + "'";
    require_finite(object.T_task_cloud, what);
    const PointCloud& cloud = object.cloud;
    if (!cloud.voxels)
      refuse(what + ": point cloud '" + cloud.file + "' has not been read");
    for (const geometry::VoxelBlock& block :
         geometry::blocks_of(*cloud.voxels, cloud.voxel_m, kBlocksOfACloud))
      add_obstacle(object.name, object.T_task_cloud * Eigen::Translation3d(block.center),
                   Solid(block, cloud.voxel_m));
  }
  require_known_names(bodies, chain, surroundings);
}

}  // namespace kinship::collision
