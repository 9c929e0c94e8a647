#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/scene.hpp"
#include "robots/kinematics/urdf.hpp"

namespace urdf {
class Pose;
}

namespace kinship::geometry {

/// A collision solid of a robot's link.
struct LinkShape {
  int link = 0;  ///< index into Chain::links()
  Shape shape;
  Eigen::Isometry3d T_link_shape = Eigen::Isometry3d::Identity();  ///< of the shape's centre
  bool approximate = false;                                        ///< fitted around a mesh
  /// The surface of that mesh in the frame of the shape: 3 x 3 n, m, three columns per triangle.
  /// Null without a mesh. Shared by the copies of a robot's shapes; immutable.
  std::shared_ptr<const Eigen::Matrix3Xd> triangles = nullptr;
};

/// The collision geometry of a robot and the pairs of links that are never checked.
struct RobotShapes {
  std::vector<LinkShape> shapes;
  std::vector<std::pair<int, int>> never_colliding;  ///< link indices, first < second
  std::vector<int> left_out = {};     ///< links with a mesh left out, ascending, distinct
  std::vector<int> visual_only = {};  ///< links with visuals and no solid, ascending
  std::vector<int> from_visual = {};  ///< links whose solids are their visuals, ascending
};

/// Gives the corners of a mesh by the URI or file name in the URDF.
/// \return 3 x 3 n, m, three columns per triangle, in the mesh's frame, not scaled; nothing if the
///         mesh is to be left out; or an error that names the URI.
using MeshSource = std::function<Result<std::optional<Eigen::Matrix3Xd>>(const std::string& uri)>;

/// A MeshSource for callers that must not miss a solid: InvalidInput for every mesh.
Result<std::optional<Eigen::Matrix3Xd>> refuse_mesh(const std::string& uri);

/// A MeshSource for callers with the URDF's text only: it leaves every mesh out of the shapes.
Result<std::optional<Eigen::Matrix3Xd>> leave_out_mesh(const std::string& uri);

/// Reads the collision elements of a robot's URDF for the links of its chain: boxes,
/// cylinders, spheres; a cylinder and two spheres of its radius at its ends become one capsule; a
/// mesh keeps its triangles, with the URDF's scale, in the box or capsule of fit_shape around them.
/// Shapes come in the order of the links; a link paired with itself is left out.
/// \return InvalidInput with the link named for a size that is not finite and positive, a mesh
///         scaled by 0 or without area, or a pair that names no link; a collision element that
///         the parser left out; the error of `meshes`, with the link named.
Result<RobotShapes> read_shapes(const kinematics::RobotModel& robot,
                                const MeshSource& meshes = refuse_mesh);

/// Tolerance of radii and centres for a cylinder and two spheres to count as one capsule, m.
inline constexpr double kFusionTolerance_m = 1e-5;

/// Replaces each cylinder that has a sphere of its radius at both ends, on the same link, by the
/// capsule that the three make up, and drops the spheres. URDF has no capsule of its own. Two
/// capsules may share an end sphere. The other shapes keep their order.
std::vector<LinkShape> fuse_capsules(const std::vector<LinkShape>& shapes);

/// A pose of the URDF's tree.
Eigen::Isometry3d to_isometry(const urdf::Pose& pose);

/// Name of the collision elements that with_visual_solids() makes.
inline constexpr const char* kFromVisual = "kinship:from_visual";

/// The URDF with the visuals of every link without collision element copied as collision elements,
/// with their origins.
/// \param except  links that get none.
/// \return InvalidInput for a text that is no XML with a `robot` element.
Result<std::string> with_visual_solids(const std::string& urdf,
                                       const std::vector<std::string>& except = {});

}  // namespace kinship::geometry
