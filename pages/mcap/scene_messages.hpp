#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "pages/mcap/writer.hpp"
#include "proto/types/scene.hpp"

/// Messages after Foxglove's public schemas foxglove.SceneUpdate and foxglove.FrameTransforms, with
/// the members that Kinship uses.
namespace kinship::mcap {

using Color = std::array<double, 4>;  ///< red, green, blue, opacity, each 0 to 1

struct Solid {
  Shape shape;
  Eigen::Isometry3d T_frame_shape = Eigen::Isometry3d::Identity();  ///< of its centre, m
};

/// A thing that is drawn in one colour, in a frame that may move.
struct Entity {
  std::string frame, id;  ///< the id is unique on its topic
  Color color;
  std::vector<Solid> solids = {};
  Eigen::Matrix3Xd line = {};  ///< points in the frame, m
  std::string caption = {};    ///< at the line's first point
  std::map<std::string, std::string> metadata = {};
};

/// T_parent_child.
struct FrameTransform {
  std::string parent, child;
  Eigen::Isometry3d T_parent_child;
};

/// A message that replaces all entities of its topic. A capsule becomes a cylinder and two spheres.
std::string scene_update(std::chrono::nanoseconds time, const std::vector<Entity>& entities);
Schema scene_update_schema();

std::string frame_transforms(std::chrono::nanoseconds time,
                             const std::vector<FrameTransform>& transforms);
Schema frame_transforms_schema();

}  // namespace kinship::mcap
