#include "client/moveit/kept_orientation.hpp"

#include <cmath>

#include "client/moveit/geometry_messages.hpp"
#include "robots/planning/kept_orientation.hpp"

namespace kinship::moveit {
namespace {

Eigen::Vector3d read_tolerances(const YamlValue& constraint) {
  constexpr const char* kNames[] = {"absolute_x_axis_tolerance", "absolute_y_axis_tolerance",
                                    "absolute_z_axis_tolerance"};
  Eigen::Vector3d tolerances;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const YamlValue value = constraint[kNames[axis]];
    tolerances[axis] = value.number();
    if (tolerances[axis] < 0)
      value.refuse("'" + value.text() + "' is below 0");
  }
  return tolerances;
}

/// Whether the tolerances are of a rotation vector; else of turns about x, y and z.
bool is_rotation_vector(const YamlValue& constraint) {
  const std::string kind = constraint["parameterization"].text_or("0");
  if (kind != "0" && kind != "1")
    constraint["parameterization"].refuse("'" + kind + "' is neither 0 nor 1");
  return kind == "1";
}

}  // namespace

std::optional<TaskSpaceRegion> read_kept_orientation(const YamlValue& constraint,
                                                     const Frames& frames,
                                                     std::vector<std::string>& left_out) {
  const auto kept =
      planning::keep_orientation(read_tolerances(constraint), is_rotation_vector(constraint));
  if (!kept)
    constraint.refuse(kept.error().message);
  if (!kept->bounds_any())
    return std::nullopt;
  if (!kept->difference.empty())
    left_out.push_back(kept->difference);
  TaskSpaceRegion region;
  region.T_task_region.linear() = frames.T_task_header(constraint).linear() *
                                  read_rotation(constraint["orientation"]).toRotationMatrix();
  region.T_region_end = frames.T_link_transfer(constraint["link_name"]);
  Eigen::Vector<double, 6> upper = Eigen::Vector<double, 6>::Constant(HUGE_VAL);
  upper.tail<3>() = kept->bounds;
  region.bounds.row(0) = -upper;
  region.bounds.row(1) = upper;
  return region;
}

}  // namespace kinship::moveit
