#pragma once

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/scene.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::geometry {

/// A collision solid of a robot's link.
struct LinkShape {
  int link = 0;  ///< index into Chain::links()
  Shape shape;
  Eigen::Isometry3d T_link_shape = Eigen::Isometry3d::Identity();  ///< of the shape's centre
};

/// The collision geometry of a robot and the pairs of links that are never checked.
struct RobotShapes {
  std::vector<LinkShape> shapes;
  std::vector<std::pair<int, int>> never_colliding;  ///< link indices, first < second
};

/// Reads the collision elements of a description's URDF for the links of its chain: boxes,
/// cylinders, spheres; a cylinder and two spheres of its radius at its ends become one capsule.
/// Shapes come in the order of the links; a link paired with itself is left out.
/// \return InvalidInput with the link named for a mesh (not supported yet), a size that is not
///         finite and positive, or a pair that names no link; what parse_urdf says of the text.
Result<RobotShapes> read_shapes(const RobotDescription& description,
                                const kinematics::Chain& chain);

}  // namespace kinship::geometry
