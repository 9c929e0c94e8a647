#include "pages/page/bones.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::page {

namespace {

/// A shape in its own frame: an axis, half the length along it, and a radius.
struct Axis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
  double half_length = 0;
  double radius = 0;
};

struct AxisOf {
  Axis operator()(const SphereShape& sphere) const {
    return {Eigen::Vector3d::UnitZ(), 0, sphere.radius_m};
  }
  Axis operator()(const CapsuleShape& capsule) const {
    return {Eigen::Vector3d::UnitZ(), capsule.length_m / 2, capsule.radius_m};
  }
  Axis operator()(const CylinderShape& cylinder) const {
    const double half = std::max(0.0, cylinder.length_m / 2 - cylinder.radius_m);
    return {Eigen::Vector3d::UnitZ(), half, cylinder.radius_m};
  }
  Axis operator()(const BoxShape& box) const {
    Eigen::Index longest = 0;
    const double length = box.size.maxCoeff(&longest);
    const double radius = (box.size.sum() - length) / 4;
    return {Eigen::Vector3d::Unit(longest), std::max(0.0, length / 2 - radius), radius};
  }
};

}  // namespace

std::vector<Bone> bones_of(const models::LoadedRobot& robot, const Eigen::Isometry3d& T_task_base,
                           const Eigen::Ref<const Eigen::VectorXd>& q) {
  const std::vector<Eigen::Isometry3d> links = kinematics::link_poses(robot.chain, q);
  std::vector<Bone> bones;
  for (const geometry::LinkShape& each : robot.shapes.shapes) {
    const Axis axis = std::visit(AxisOf{}, each.shape);
    const Eigen::Isometry3d T_task_shape =
        T_task_base * links[static_cast<std::size_t>(each.link)] * each.T_link_shape;
    const Eigen::Vector3d half = T_task_shape.linear() * axis.direction * axis.half_length;
    bones.push_back(
        {T_task_shape.translation() - half, T_task_shape.translation() + half, axis.radius});
  }
  return bones;
}

std::vector<SceneObject> held_objects(const models::LoadedRobot& robot,
                                      const std::vector<AttachedObject>& attached,
                                      const Eigen::Isometry3d& T_task_base,
                                      const Eigen::Ref<const Eigen::VectorXd>& q) {
  const std::vector<Eigen::Isometry3d> links = kinematics::link_poses(robot.chain, q);
  std::vector<SceneObject> held;
  for (const AttachedObject& each : attached) {
    if (each.mesh)
      continue;
    const int link = robot.chain.find_link(each.link);
    if (link < 0)
      throw std::invalid_argument("held_objects: no link '" + each.link + "'");
    held.push_back({each.name, each.shape,
                    T_task_base * links[static_cast<std::size_t>(link)] * each.T_link_object});
  }
  return held;
}

namespace {

void add_box_around(const std::string& name, const std::shared_ptr<const Eigen::Matrix3Xd>& points,
                    double margin_m, const Eigen::Isometry3d& T_task_points,
                    std::vector<SceneObject>& objects) {
  if (points == nullptr || points->cols() == 0)
    return;
  const Eigen::Vector3d lower = points->rowwise().minCoeff().array() - margin_m;
  const Eigen::Vector3d upper = points->rowwise().maxCoeff().array() + margin_m;
  objects.push_back({name, BoxShape{upper - lower},
                     T_task_points * Eigen::Translation3d((lower + upper) / 2), true});
}

}  // namespace

std::vector<SceneObject> drawn_objects(const Scene& scene) {
  std::vector<SceneObject> objects = scene.objects;
  for (const SceneMesh& each : scene.meshes)
    add_box_around(each.name, each.mesh.triangles, 0, each.T_task_mesh, objects);
  for (const SceneCloud& each : scene.clouds)
    add_box_around(each.name, each.cloud.voxels, each.cloud.voxel_m / 2, each.T_task_cloud,
                   objects);
  return objects;
}

}  // namespace kinship::page
