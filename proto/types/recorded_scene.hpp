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

/// An object held by a robot, given in the transfer frame, so that another robot can hold it too.
struct HeldObject {
  std::string name;
  Shape shape;
  Eigen::Isometry3d T_transfer_object = Eigen::Isometry3d::Identity();  ///< of the shape's centre
  bool approximate = false;  ///< fitted around a mesh, which lies inside
};

/// The scene in which an attempt was planned, independent of its robot: no link names, because the
/// scene serves other robots. Primitives only; a mesh is replaced by solids around it.
struct RecordedScene {
  std::vector<SceneObject> objects;  ///< in the task frame
  std::vector<HeldObject> held;
  /// Pairs of names of objects or held objects that may touch, e.g. a held object and the table it
  /// was taken from.
  std::vector<std::pair<std::string, std::string>> allowed_collisions;
  /// Region that the transfer frame had to keep along the whole path; in the task frame.
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

/// Bytes of a scene that count against kMaxSceneBytes: 96 bytes for each object and held object, 16
/// for each allowed pair, the bytes of their names, and 216 for a constraint.
std::size_t scene_bytes(const RecordedScene& scene);

/// The rule of the contract that a scene breaks, if any: names of 1 to kMaxLinkNameBytes of text,
/// sizes above 0 and at most kMaxPlacement_m, proper poses, allowed pairs of existing names, a
/// constraint that can be kept, and the limits on counts and bytes. The message begins with
/// "scene", that of a constraint with "scene: constraint".
std::optional<Error> check_scene(const RecordedScene& scene);

/// Digest by which equal scenes are stored once: equal for scenes that differ in the order of their
/// lists, in the orientation of spheres, or by less than about 1e-9 (m, rad, parts of a
/// quaternion). Bounds of a constraint beyond 9e9 count as infinite.
Digest content_digest(const RecordedScene& scene);

}  // namespace kinship
