#pragma once

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <octomap/OcTree.h>

#include <cstddef>
#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "robots/collision/collision_world.hpp"

/// What FCL does by itself, as a reference.
namespace kinship::bench {

inline std::shared_ptr<fcl::CollisionGeometry<double>> fcl_shape(const Shape& shape) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return std::make_shared<fcl::Box<double>>(box->size);
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return std::make_shared<fcl::Cylinder<double>>(cylinder->radius_m, cylinder->length_m);
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return std::make_shared<fcl::Sphere<double>>(sphere->radius_m);
  const auto& capsule = std::get<CapsuleShape>(shape);
  return std::make_shared<fcl::Capsule<double>>(capsule.radius_m, capsule.length_m);
}

/// \param triangles  3 x 3 n, m, three columns per triangle
inline std::shared_ptr<fcl::CollisionGeometry<double>> fcl_mesh(const Eigen::Matrix3Xd& triangles) {
  auto mesh = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
  mesh->beginModel(static_cast<int>(triangles.cols() / 3), static_cast<int>(triangles.cols()));
  for (Eigen::Index i = 0; i < triangles.cols(); i += 3)
    mesh->addTriangle(triangles.col(i), triangles.col(i + 1), triangles.col(i + 2));
  mesh->endModel();
  mesh->computeLocalAABB();
  return mesh;
}

inline std::shared_ptr<fcl::OcTree<double>> fcl_octree(
    const std::shared_ptr<const octomap::OcTree>& map) {
  auto tree = std::make_shared<fcl::OcTree<double>>(map);
  tree->computeLocalAABB();
  return tree;
}

/// A robot and what it holds among the occupied cubes of one map: FCL asks each body that moves
/// about the whole map. Pairs of bodies are asked about as by CollisionWorld::find_contact.
class OctreeWorld {
 public:
  /// \param shapes  the robot's
  /// \param around  without a scene
  OctreeWorld(const collision::RobotSolids& robot, const geometry::RobotShapes& shapes,
              const collision::Surroundings& around, std::shared_ptr<fcl::OcTree<double>> tree)
      : chain_(robot.parts().chain),
        alone_(robot, around),
        bodies_(collision::bodies_among(robot, around)),
        T_base_bodies_(collision::standing_poses(bodies_)),
        tree_(std::move(tree)) {
    for (const geometry::LinkShape& each : shapes.shapes)
      geometries_.push_back(each.triangles ? fcl_mesh(*each.triangles) : fcl_shape(each.shape));
    for (const AttachedObject& each : around.attached)
      geometries_.push_back(fcl_shape(each.shape));
  }

  bool collides(const Eigen::VectorXd& q) {
    if (alone_.find_contact(q))
      return true;
    collision::place_bodies(chain_, bodies_, q, T_base_bodies_);
    const fcl::CollisionRequest<double> request(1, /*enable_contact_=*/false);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      fcl::CollisionResult<double> result;
      if (bodies_[i].joint >= 0 &&
          fcl::collide(geometries_[i].get(), T_base_bodies_[i], tree_.get(),
                       Eigen::Isometry3d::Identity(), request, result) > 0)
        return true;
    }
    return false;
  }

 private:
  kinematics::Chain chain_;
  collision::CollisionWorld alone_;
  std::vector<collision::Body> bodies_;  // links, then what is held
  std::vector<Eigen::Isometry3d> T_base_bodies_;
  std::vector<std::shared_ptr<fcl::CollisionGeometry<double>>> geometries_;  // one a body
  std::shared_ptr<fcl::OcTree<double>> tree_;
};

}  // namespace kinship::bench
