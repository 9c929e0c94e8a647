#pragma once

#include <Eigen/Geometry>
#include <vector>

/// Layout of a scene for the lanes; for this library's sources only.
namespace kinship::collision {

/// Whether a rotation maps axes to axes: a box turned by it is a box along the axes again.
bool is_of_quarter_turns(const Eigen::Matrix3d& R);

/// The axes along which most of some boxes lie, among the axes of the first few; the identity for
/// none.
/// \param axes  of each box, one per column.
Eigen::Matrix3d common_axes(const std::vector<Eigen::Matrix3d>& axes);

}  // namespace kinship::collision
