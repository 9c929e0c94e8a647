#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/scene.hpp"
#include "proto/types/task_space_region.hpp"

namespace kinship {

/// Something that a robot held, said in the transfer frame, so that another robot can hold it too.
struct HeldObject {
  std::string name;
  Shape shape;
  Eigen::Isometry3d T_transfer_object = Eigen::Isometry3d::Identity();  ///< of the shape's centre
  bool approximate = false;  ///< fitted around a mesh, which lies inside
};

/// The scene in which an attempt was planned, said without its robot: no link names, because the
/// scene is there for other robots. Primitives only; a mesh is there as solids around it.
struct RecordedScene {
  std::vector<SceneObject> objects;  ///< in the task frame
  std::vector<HeldObject> held;
  /// Names of objects or held things that may touch, e.g. what stands on a table when it is taken.
  std::vector<std::pair<std::string, std::string>> allowed_collisions;
  /// Where the transfer frame had to stay along the whole path; in the task frame.
  std::optional<TaskSpaceRegion> constraint = {};
};

/// A shape as numbers, for messages and blobs: index into the variant, and sizes in m; sizes that
/// the shape does not have are 0. Box: full extents; cylinder and capsule: radius, length; sphere:
/// radius.
struct ShapeNumbers {
  std::size_t kind = 0;
  std::array<double, 3> sizes{};
};

ShapeNumbers to_numbers(const Shape& shape);
/// \throws std::invalid_argument for a kind above that of the last shape.
Shape to_shape(const ShapeNumbers& numbers);

/// What a scene counts against kMaxSceneBytes: 96 bytes for each object and held thing, 16 for each
/// allowed pair, the bytes of their names, and 216 for a constraint.
std::size_t scene_bytes(const RecordedScene& scene);

/// The rule of the contract that a scene breaks, if any: names of 1 to kMaxLinkNameBytes of text,
/// sizes above 0 and at most kMaxPlacement_m, proper poses, allowed pairs of names that are there,
/// a constraint that can be kept, and the limits on counts and bytes. The message begins with
/// "scene", that of a constraint with "scene: constraint".
std::optional<Error> check_scene(const RecordedScene& scene);

/// What a scene is kept once by: equal for scenes that differ in the order of their lists, in the
/// orientation of spheres, or by less than about 1e-9 (m, rad, parts of a quaternion). Bounds of a
/// constraint beyond 9e9 count as infinite.
Digest content_digest(const RecordedScene& scene);

}  // namespace kinship
