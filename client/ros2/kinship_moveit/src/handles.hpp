#pragma once

#include <kinship.h>
#include <kinship_planning.h>

#include <Eigen/Geometry>
#include <array>
#include <memory>

namespace kinship_moveit {

/// Frees handles of libkinship.
struct Release {
  void operator()(kinship_client* handle) const { kinship_client_close(handle); }
  void operator()(kinship_distribution* handle) const { kinship_distribution_free(handle); }
  void operator()(kinship_follower* handle) const { kinship_follower_close(handle); }
  void operator()(kinship_plan* handle) const { kinship_plan_free(handle); }
  void operator()(kinship_planner* handle) const { kinship_planner_free(handle); }
  void operator()(kinship_recall* handle) const { kinship_recall_free(handle); }
  void operator()(kinship_sampler* handle) const { kinship_sampler_free(handle); }
};

template <typename Handle>
using Owned = std::unique_ptr<Handle, Release>;

/// A structure of libkinship that says its size.
template <typename Structure>
Structure sized() {
  Structure structure{};
  structure.size = sizeof structure;
  return structure;
}

using PoseNumbers = std::array<double, 7>;  ///< x y z qx qy qz qw

inline PoseNumbers to_numbers(const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(T.linear()).normalized();
  const Eigen::Vector3d at = T.translation();
  return {at.x(), at.y(), at.z(), turn.x(), turn.y(), turn.z(), turn.w()};
}

inline Eigen::Isometry3d to_pose(const PoseNumbers& numbers) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  T.linear() = Eigen::Quaterniond(numbers[6], numbers[3], numbers[4], numbers[5])
                   .normalized()
                   .toRotationMatrix();
  return T;
}

}  // namespace kinship_moveit
