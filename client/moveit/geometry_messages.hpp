#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "client/moveit/yaml_value.hpp"
#include "proto/types/scene.hpp"

/// geometry_msgs and shape_msgs, as `ros2 topic echo` writes them (`{x: 0, y: 0, z: 1}`, numbers
/// for kinds) and as benchmark sets do (`[0, 0, 1]`, words for kinds). All throw
/// Failure(InvalidInput) with the place named.
namespace kinship::moveit {

/// A point or vector; zero if it is missing.
Eigen::Vector3d read_vector(const YamlValue& value);

/// Normalised; identity if it is missing or zero, as in messages left empty.
Eigen::Quaterniond read_rotation(const YamlValue& value);

/// geometry_msgs/Pose, or Transform with its other names; identity if it is missing.
Eigen::Isometry3d read_pose(const YamlValue& value);

/// shape_msgs/SolidPrimitive: a box, sphere or cylinder; cones and prisms are refused.
Shape read_solid(const YamlValue& value);

/// shape_msgs/Mesh as Wavefront OBJ.
std::string read_mesh(const YamlValue& value);

}  // namespace kinship::moveit
