#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>

namespace kinship {

/// A box in the space of poses that the transfer frame must not leave along a whole path: x, y, z
/// (m) and roll, pitch, yaw (rad, R = Rz(yaw) Ry(pitch) Rx(roll)) of the frame "end" in the frame
/// "region". Both frames coincide where the transfer frame is at T_task_region * T_region_end.
/// Source: Berenson, Srinivasa and Kuffner, Task Space Regions (IJRR 2011), section 4.
struct TaskSpaceRegion {
  Eigen::Isometry3d T_task_region = Eigen::Isometry3d::Identity();  ///< "T0_w"
  /// "Tw_e": transfer frame in the region frame at zero displacement.
  Eigen::Isometry3d T_region_end = Eigen::Isometry3d::Identity();
  /// "Bw": lower and upper displacement; infinite without a bound. Zero need not lie within. Angles
  /// count modulo a full turn; one bound of an angle alone leaves half a turn on the other side.
  Eigen::Matrix<double, 2, 6> bounds = Eigen::Matrix<double, 2, 6>::Zero();
};

/// The name of a displacement's coordinate, 0 to 5: x, y, z, roll, pitch, yaw.
const char* displacement_name(Eigen::Index coordinate);

/// The first fault of a region, as text with its value: bounds that are NaN, crossed or exclude
/// everything, a pose that is not finite or not rigid.
std::optional<std::string> validate(const TaskSpaceRegion& region);

}  // namespace kinship
