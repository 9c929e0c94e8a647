#include "robots/geometry/link_shapes.hpp"

#include <urdf_model/model.h>

#include <algorithm>
#include <optional>

#include "robots/geometry/capsule_fusion.hpp"
#include "robots/geometry/shape_rules.hpp"
#include "robots/kinematics/urdf_model.hpp"

namespace kinship::geometry {
namespace {

Error invalid(const std::string& message) { return {ErrorCode::InvalidInput, message}; }

std::optional<Shape> to_shape(const urdf::Geometry& geometry) {
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry))
    return BoxShape{{box->dim.x, box->dim.y, box->dim.z}};
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry))
    return CylinderShape{cylinder->radius, cylinder->length};
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry))
    return SphereShape{sphere->radius};
  return std::nullopt;
}

Eigen::Isometry3d to_isometry(const urdf::Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << pose.position.x, pose.position.y, pose.position.z;
  const Eigen::Quaterniond rotation(pose.rotation.w, pose.rotation.x, pose.rotation.y,
                                    pose.rotation.z);
  T.linear() = rotation.normalized().toRotationMatrix();
  return T;
}

/// The shape of one collision element; nothing if the element is empty.
Result<std::optional<LinkShape>> read_collision(const urdf::Collision& collision,
                                                const std::string& link_name, int link) {
  if (!collision.geometry)
    return std::optional<LinkShape>();
  const auto shape = to_shape(*collision.geometry);
  if (!shape)
    return invalid("link '" + link_name + "': collision meshes are not supported yet");
  if (const auto why = broken_rule(*shape))
    return invalid("link '" + link_name + "': " + *why);
  const LinkShape result{link, *shape, to_isometry(collision.origin)};
  if (!result.T_link_shape.matrix().allFinite())
    return invalid("link '" + link_name + "': collision origin is not finite");
  return std::optional<LinkShape>(result);
}

Result<std::vector<LinkShape>> read_links(const urdf::ModelInterface& model,
                                          const kinematics::Chain& chain) {
  std::vector<LinkShape> shapes;
  for (const auto& [name, link] : model.links_) {
    const int index = chain.find_link(name);
    if (index < 0)
      return invalid("link '" + name + "' of the URDF is not a link of the chain");
    for (const auto& collision : link->collision_array) {
      if (!collision)
        continue;
      const auto shape = read_collision(*collision, name, index);
      if (!shape)
        return shape.error();
      if (*shape)
        shapes.push_back(**shape);
    }
  }
  std::stable_sort(shapes.begin(), shapes.end(),
                   [](const LinkShape& a, const LinkShape& b) { return a.link < b.link; });
  return shapes;
}

Error no_such_link(const std::string& first, const std::string& second, const std::string& name) {
  return invalid("never-colliding pair ('" + first + "', '" + second + "'): no link named '" +
                 name + "'");
}

Result<std::vector<std::pair<int, int>>> read_pairs(const RobotDescription& description,
                                                    const kinematics::Chain& chain) {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [first, second] : description.never_colliding) {
    const int a = chain.find_link(first);
    const int b = chain.find_link(second);
    if (a < 0 || b < 0)
      return no_such_link(first, second, a < 0 ? first : second);
    if (a != b)
      pairs.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace

Result<RobotShapes> read_shapes(const RobotDescription& description,
                                const kinematics::Chain& chain) {
  const auto model = kinematics::parse_urdf(description.urdf);
  if (!model)
    return model.error();
  auto shapes = read_links(**model, chain);
  if (!shapes)
    return shapes.error();
  auto pairs = read_pairs(description, chain);
  if (!pairs)
    return pairs.error();
  return RobotShapes{fuse_capsules(*shapes), *std::move(pairs)};
}

}  // namespace kinship::geometry
