#include "scene_objects.hpp"

#include <geometric_shapes/shapes.h>
#include <octomap/octomap.h>

#include <algorithm>
#include <iterator>

namespace kinship_moveit {
namespace {

constexpr double kPlane_m = 20, kPlaneThickness_m = 0.001;  // of the box that stands for a plane

/// Corners of all triangles.
std::vector<double> triangles_of(const shapes::Mesh& mesh) {
  std::vector<double> points;
  points.reserve(std::size_t{9} * mesh.triangle_count);
  for (unsigned int corner = 0; corner < 3 * mesh.triangle_count; ++corner)
    for (unsigned int axis = 0; axis < 3; ++axis)
      points.push_back(mesh.vertices[3 * mesh.triangles[corner] + axis]);
  return points;
}

constexpr std::size_t kMaxCells = 500'000;  // as libkinship takes them

/// Middles of all occupied cells of the finest resolution: coarser leaves are cut. More than
/// kMaxCells if there are so many, then not all.
std::vector<double> cells_of(const octomap::OcTree& tree) {
  std::vector<double> points;
  const double edge_m = tree.getResolution();
  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf) {
    if (!tree.isNodeOccupied(*leaf))
      continue;
    const int cells = static_cast<int>(leaf.getSize() / edge_m + 0.5);
    const std::size_t more = static_cast<std::size_t>(cells) * cells * cells;
    if (points.size() / 3 + more > kMaxCells)
      return std::vector<double>(3 * (kMaxCells + 1));
    const double first_m = 0.5 * edge_m * (1 - cells);
    for (int x = 0; x < cells; ++x)
      for (int y = 0; y < cells; ++y)
        for (int z = 0; z < cells; ++z)
          points.insert(points.end(),
                        {leaf.getX() + first_m + edge_m * x, leaf.getY() + first_m + edge_m * y,
                         leaf.getZ() + first_m + edge_m * z});
  }
  return points;
}

/// Where the plane a x + b y + c z + d = 0 is nearest to the origin, z along its normal.
Eigen::Isometry3d T_shape_plane(const shapes::Plane& plane) {
  const Eigen::Vector3d normal(plane.a, plane.b, plane.c);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
  T.translation() = -plane.d / normal.squaredNorm() * normal;
  return T;
}

bool is_always_allowed(const collision_detection::AllowedCollisionMatrix& matrix,
                       const std::string& first, const std::string& second) {
  collision_detection::AllowedCollision::Type type{};
  return matrix.getAllowedCollision(first, second, type) &&
         type == collision_detection::AllowedCollision::ALWAYS;
}

/// The name of one shape of an object: names of objects are unique.
std::string part_name(const std::string& id, std::size_t index, std::size_t count) {
  return count == 1 ? id : id + "/" + std::to_string(index + 1);
}

}  // namespace

SceneObjects::SceneObjects(const planning_scene::PlanningScene& scene,
                           const moveit::core::RobotState& state, const std::string& tip_link,
                           const Eigen::Isometry3d& T_tip_transfer,
                           const Eigen::Isometry3d& T_task_world) {
  for (const std::string& id : scene.getWorld()->getObjectIds()) {
    const auto object = scene.getWorld()->getObject(id);
    for (std::size_t i = 0; object && i < object->shapes_.size(); ++i)
      add(id, part_name(id, i, object->shapes_.size()), *object->shapes_[i],
          T_task_world * object->global_shape_poses_[i], false);
  }
  using moveit::core::RobotModel;
  const RobotModel& model = *scene.getRobotModel();
  const auto* tip = model.getLinkModel(tip_link);
  const Eigen::Isometry3d T_transfer_world =
      (state.getGlobalLinkTransform(tip_link) * T_tip_transfer).inverse();
  std::vector<const moveit::core::AttachedBody*> attached;
  state.getAttachedBodies(attached);
  for (const moveit::core::AttachedBody* body : attached) {
    if (RobotModel::getRigidlyConnectedParentLinkModel(body->getAttachedLink()) !=
        RobotModel::getRigidlyConnectedParentLinkModel(tip)) {
      untold_ = "'" + body->getName() + "' is attached to '" + body->getAttachedLinkName() +
                "', which does not move with '" + tip_link + "'";
      continue;
    }
    const auto& T_world_shapes = body->getGlobalCollisionBodyTransforms();
    const std::string& id = body->getName();
    for (std::size_t i = 0; i < body->getShapes().size(); ++i)
      add(id, part_name(id, i, body->getShapes().size()), *body->getShapes()[i],
          T_transfer_world * T_world_shapes[i], true);
  }
  allow_pairs(scene, attached);
}

void SceneObjects::add(const std::string& id, const std::string& name, const shapes::Shape& shape,
                       const Eigen::Isometry3d& T, bool is_held) {
  auto object = sized<kinship_object>();
  object.is_held = is_held ? 1 : 0;
  Eigen::Isometry3d T_frame_object = T;
  switch (shape.type) {
    case shapes::BOX:
      object.shape = KINSHIP_BOX;
      std::copy_n(static_cast<const shapes::Box&>(shape).size, 3, object.sizes);
      break;
    case shapes::SPHERE:
      object.shape = KINSHIP_SPHERE;
      object.sizes[0] = static_cast<const shapes::Sphere&>(shape).radius;
      break;
    case shapes::CYLINDER:
      object.shape = KINSHIP_CYLINDER;
      object.sizes[0] = static_cast<const shapes::Cylinder&>(shape).radius;
      object.sizes[1] = static_cast<const shapes::Cylinder&>(shape).length;
      break;
    case shapes::CONE:  // the cylinder around it
      object.shape = KINSHIP_CYLINDER;
      object.sizes[0] = static_cast<const shapes::Cone&>(shape).radius;
      object.sizes[1] = static_cast<const shapes::Cone&>(shape).length;
      break;
    case shapes::PLANE:
      object.shape = KINSHIP_BOX;
      object.sizes[0] = object.sizes[1] = kPlane_m;
      object.sizes[2] = kPlaneThickness_m;
      T_frame_object = T * T_shape_plane(static_cast<const shapes::Plane&>(shape));
      break;
    case shapes::MESH:
      object.shape = KINSHIP_MESH;
      add_points(triangles_of(static_cast<const shapes::Mesh&>(shape)), object);
      break;
    case shapes::OCTREE: {
      const octomap::OcTree& tree = *static_cast<const shapes::OcTree&>(shape).octree;
      object.shape = KINSHIP_VOXELS;
      object.sizes[0] = tree.getResolution();
      add_points(cells_of(tree), object);
      if (object.point_count > kMaxCells) {
        untold_ = "'" + name + "' has more than " + std::to_string(kMaxCells) + " occupied cells";
        return;
      }
      break;
    }
    default:
      untold_ = "'" + name + "' has a shape that is not known";
      return;
  }
  const bool has_points = object.shape == KINSHIP_MESH || object.shape == KINSHIP_VOXELS;
  if (has_points && object.point_count == 0)
    return;  // an octomap without an occupied cell
  names_.push_back(name);
  object.name = names_.back().c_str();
  parts_[id].push_back(object.name);
  const PoseNumbers pose = to_numbers(T_frame_object);
  std::copy(pose.begin(), pose.end(), object.pose);
  objects_.push_back(object);
}

void SceneObjects::add_points(std::vector<double> points, kinship_object& object) {
  points_.push_back(std::move(points));
  object.points = points_.back().data();
  object.point_count = points_.back().size() / 3;
}

void SceneObjects::allow(const Parts& first, const Parts& second, bool are_objects) {
  for (const char* one : first)
    for (const char* other : second)
      for (const char* name : {one, other}) {
        allowed_.push_back(name);
        if (are_objects)
          allowed_objects_.push_back(name);
      }
}

void SceneObjects::allow_pairs(const planning_scene::PlanningScene& scene,
                               const std::vector<const moveit::core::AttachedBody*>& attached) {
  const auto& links = scene.getRobotModel()->getLinkModelNamesWithCollisionGeometry();
  const auto& matrix = scene.getAllowedCollisionMatrix();
  const auto part = [this](const std::string& link) {
    return Parts{names_.emplace_back(link).c_str()};
  };
  for (auto first = parts_.begin(); first != parts_.end(); ++first) {
    for (const std::string& link : links)
      if (is_always_allowed(matrix, first->first, link))
        allow(first->second, part(link), false);
    for (auto second = std::next(first); second != parts_.end(); ++second)
      if (is_always_allowed(matrix, first->first, second->first))
        allow(first->second, second->second, true);
  }
  for (auto first = links.begin(); first != links.end(); ++first)
    for (auto second = std::next(first); second != links.end(); ++second)
      if (is_always_allowed(matrix, *first, *second))
        allow(part(*first), part(*second), false);
  for (const moveit::core::AttachedBody* body : attached)
    if (const auto parts = parts_.find(body->getName()); parts != parts_.end())
      for (const std::string& link : body->getTouchLinks())
        if (const auto known = std::find(links.begin(), links.end(), link); known != links.end())
          allow(parts->second, part(*known), false);
}

}  // namespace kinship_moveit
