#include "robots/geometry/capsule_fusion.hpp"

#include <cmath>
#include <cstddef>
#include <optional>

namespace kinship::geometry {
namespace {

/// Index of a sphere of that link, radius and centre in the link's frame.
std::optional<std::size_t> find_sphere(const std::vector<LinkShape>& shapes, int link,
                                       double radius_m, const Eigen::Vector3d& p_link_center) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto* sphere = std::get_if<SphereShape>(&shapes[i].shape);
    if (sphere != nullptr && shapes[i].link == link &&
        std::abs(sphere->radius_m - radius_m) <= kFusionTolerance_m &&
        (shapes[i].T_link_shape.translation() - p_link_center).norm() <= kFusionTolerance_m)
      return i;
  }
  return std::nullopt;
}

}  // namespace

std::vector<LinkShape> fuse_capsules(const std::vector<LinkShape>& shapes) {
  std::vector<LinkShape> fused = shapes;
  std::vector<bool> covered(shapes.size(), false);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto* cylinder = std::get_if<CylinderShape>(&shapes[i].shape);
    if (cylinder == nullptr)
      continue;
    const Eigen::Vector3d p_shape_end(0, 0, cylinder->length_m / 2);
    const auto top = find_sphere(shapes, shapes[i].link, cylinder->radius_m,
                                 shapes[i].T_link_shape * p_shape_end);
    const auto bottom = find_sphere(shapes, shapes[i].link, cylinder->radius_m,
                                    shapes[i].T_link_shape * -p_shape_end);
    if (!top || !bottom || top == bottom)
      continue;
    covered[*top] = covered[*bottom] = true;
    fused[i].shape = CapsuleShape{cylinder->radius_m, cylinder->length_m};
  }
  std::vector<LinkShape> kept;
  for (std::size_t i = 0; i < fused.size(); ++i)
    if (!covered[i])
      kept.push_back(fused[i]);
  return kept;
}

}  // namespace kinship::geometry
