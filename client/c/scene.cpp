#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "proto/types/number_text.hpp"
#include "proto/types/recorded_scene.hpp"
#include "proto/types/scene_names.hpp"
#include "robots/geometry/fitted_shape.hpp"
#include "robots/geometry/mesh.hpp"
#include "robots/geometry/point_cloud.hpp"

namespace kinship::c_library {
namespace {

/// One object of a scene, before it is known as what it hangs there.
struct GivenObject {
  std::string name;
  Eigen::Isometry3d T_frame_object;
  const kinship_object& given;
};

/// \return 3 x n, m. \throws Failure(InvalidInput) if there are none, or one is not finite;
///         TooLarge beyond `most`.
std::shared_ptr<const Eigen::Matrix3Xd> read_points(const GivenObject& object, std::size_t most) {
  const kinship_object& given = object.given;
  const std::string what = "object '" + object.name + "'";
  require(given.points, (what + "->points").c_str());
  if (given.point_count == 0)
    throw Failure(invalid_input(what + " has no points"));
  if (given.point_count > most)
    throw Failure(ErrorCode::TooLarge, what + " has " + std::to_string(given.point_count) +
                                           " points, at most " + std::to_string(most));
  auto points = std::make_shared<Eigen::Matrix3Xd>(Eigen::Map<const Eigen::Matrix3Xd>(
      given.points, 3, static_cast<Eigen::Index>(given.point_count)));
  if (!points->allFinite())
    throw Failure(invalid_input(what + " has a point that is not finite"));
  return points;
}

Mesh read_triangles(const GivenObject& object) {
  if (object.given.point_count % 3 != 0)
    throw Failure(invalid_input("object '" + object.name +
                                "': a mesh has three points a triangle, "
                                "not " +
                                std::to_string(object.given.point_count) + " points"));
  return {.file = {}, .triangles = read_points(object, 3 * geometry::kMaxMeshTriangles)};
}

/// The cubes that hold the given middles, each once.
PointCloud read_voxels(const GivenObject& object) {
  const double edge_m = object.given.sizes[0];
  if (!(edge_m > 0 && edge_m <= 1))
    throw Failure(invalid_input("object '" + object.name + "': its voxels are " +
                                number_text(edge_m) + " m wide, must be above 0, at most 1"));
  return {.file = {},
          .voxel_m = edge_m,
          .voxels = std::make_shared<const Eigen::Matrix3Xd>(
              geometry::voxels_of(*read_points(object, geometry::kMaxVoxels), edge_m)
                  .value_or_throw())};
}

Shape read_shape(const GivenObject& object) {
  ShapeNumbers shape;
  shape.kind = static_cast<std::size_t>(object.given.shape);
  std::copy_n(std::begin(object.given.sizes), shape.sizes.size(), shape.sizes.begin());
  Shape read = to_shape(shape);
  if (const auto why = geometry::broken_rule(read))
    throw Failure(invalid_input("object '" + object.name + "': " + *why));
  return read;
}

void add_held(const GivenObject& object, GivenScene& scene) {
  AttachedObject held{.name = object.name,
                      .link = {},
                      .shape = {},
                      .T_link_object = object.T_frame_object,
                      .touch_links = {}};
  if (object.given.shape == KINSHIP_VOXELS)
    throw Failure(invalid_input("object '" + object.name + "': voxels cannot be held"));
  if (object.given.shape == KINSHIP_MESH)
    held.mesh = read_triangles(object);
  else
    held.shape = read_shape(object);
  scene.held.push_back(std::move(held));
}

void add_object(const kinship_object& given, const std::string& where, GivenScene& scene) {
  require(given.name, ("a name in " + where).c_str());
  const std::string what = "object '" + std::string(given.name) + "'";
  if (given.shape < KINSHIP_BOX || given.shape > KINSHIP_VOXELS)
    throw Failure(invalid_input(what + ": its shape is " + std::to_string(given.shape) +
                                ", must be 0 to " + std::to_string(KINSHIP_VOXELS)));
  const GivenObject object{given.name, read_pose(std::begin(given.pose), what.c_str()), given};
  if (given.is_held != 0)
    add_held(object, scene);
  else if (given.shape == KINSHIP_MESH)
    scene.scene.meshes.push_back({object.name, read_triangles(object), object.T_frame_object});
  else if (given.shape == KINSHIP_VOXELS)
    scene.scene.clouds.push_back({object.name, read_voxels(object), object.T_frame_object});
  else
    scene.scene.objects.push_back({object.name, read_shape(object), object.T_frame_object});
}

}  // namespace

GivenScene read_scene(const SceneMembers& given, const std::string& name) {
  const std::string objects = name + "->objects";
  if (given.object_count > 0)
    require(given.objects, objects.c_str());
  GivenScene scene;
  // A caller that was compiled with another version has objects of another size.
  const auto* bytes = reinterpret_cast<const char*>(given.objects);  // NOLINT: steps of that size
  const std::size_t step = given.object_count > 0 ? given.objects->size : 0;
  for (std::size_t i = 0; i < given.object_count; ++i) {
    const kinship_object object =  // NOLINTNEXTLINE: of the array that the caller has
        read_structure(reinterpret_cast<const kinship_object*>(bytes + i * step), "object");
    if (object.size != step)
      throw Failure(invalid_input("object " + std::to_string(i) + ": its size is " +
                                  std::to_string(object.size) + ", that of the first is " +
                                  std::to_string(step)));
    add_object(object, objects, scene);
  }
  if (const auto repeated = find_repeated_name(scene.scene))
    throw Failure(invalid_input("object '" + *repeated + "': two in " + objects +
                                " have this name; each needs one of its own"));
  scene.allowed_collisions = read_pairs(given.allowed_collisions, given.allowed_collision_pairs,
                                        (name + "->allowed_collisions").c_str());
  return scene;
}

collision::Surroundings read_surroundings(const kinship_surroundings& given,
                                          const kinematics::Chain& chain) {
  collision::Surroundings surroundings;
  if (given.T_task_base != nullptr)
    surroundings.T_task_base = read_pose(given.T_task_base, "surroundings->T_task_base");
  GivenScene scene = read_scene(
      {given.objects, given.object_count, given.allowed_collisions, given.allowed_collision_pairs},
      "surroundings");
  surroundings.scene = std::move(scene.scene);
  for (AttachedObject& held : scene.held) {
    held.link = chain.tip_link();
    held.T_link_object = chain.T_tip_transfer() * held.T_link_object;
  }
  surroundings.attached = std::move(scene.held);
  surroundings.allowed_collisions = std::move(scene.allowed_collisions);
  return surroundings;
}

}  // namespace kinship::c_library
