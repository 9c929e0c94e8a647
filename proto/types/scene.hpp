#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace kinship {

struct BoxShape {
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< full extents, m
};
struct CylinderShape {
  double radius_m = 0;
  double length_m = 0;  ///< along z
};
struct SphereShape {
  double radius_m = 0;
};
struct CapsuleShape {
  double radius_m = 0;
  double length_m = 0;  ///< of the cylindrical part, along z
};

/// A solid, centred in its own frame.
using Shape = std::variant<BoxShape, CylinderShape, SphereShape, CapsuleShape>;

/// An obstacle of a scene; the pose is that of the shape's centre in the task frame.
struct SceneObject {
  std::string name;
  Shape shape;
  Eigen::Isometry3d T_task_object = Eigen::Isometry3d::Identity();
  bool approximate = false;  ///< fitted around a mesh, which lies inside
};

/// A surface of triangles in a file that a problem names.
struct Mesh {
  std::string file;  ///< a name relative to the problem file, package://NAME/FILE or file:///FILE
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  /// The corners in the mesh's own frame, scaled: 3 x 3 n, m, three columns a triangle. Null until
  /// models::SceneMeshes has read the file. Shared by copies, and never changed.
  std::shared_ptr<const Eigen::Matrix3Xd> triangles = nullptr;
};

/// An obstacle of a scene that is a mesh.
struct SceneMesh {
  std::string name;
  Mesh mesh;
  Eigen::Isometry3d T_task_mesh = Eigen::Isometry3d::Identity();
};

/// A sensor's point cloud, in a file that a problem names: the cubes of a grid that contain points.
struct PointCloud {
  std::string file;       ///< see Mesh::file
  double voxel_m = 0.02;  ///< edge of a cube
  /// The middles of the cubes in the cloud's own frame, each once: 3 x n, m, odd multiples of half
  /// an edge. Null until models::SceneMeshes has read the file. Shared by copies, never changed.
  std::shared_ptr<const Eigen::Matrix3Xd> voxels = nullptr;
};

/// An obstacle of a scene that is a point cloud.
struct SceneCloud {
  std::string name;
  PointCloud cloud;
  Eigen::Isometry3d T_task_cloud = Eigen::Isometry3d::Identity();
};

/// An object held by the robot.
struct AttachedObject {
  std::string name;
  std::string link;
  Shape shape;
  Eigen::Isometry3d T_link_object = Eigen::Isometry3d::Identity();
  std::vector<std::string> touch_links;     ///< may touch it
  std::optional<Mesh> mesh = std::nullopt;  ///< instead of the shape
};

/// The obstacles around a robot, in the task frame.
struct Scene {
  std::vector<SceneObject> objects;
  std::vector<SceneMesh> meshes = {};
  std::vector<SceneCloud> clouds = {};
};

}  // namespace kinship
