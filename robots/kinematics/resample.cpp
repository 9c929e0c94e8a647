#include "robots/kinematics/resample.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "proto/types/limits.hpp"

namespace kinship::kinematics {
namespace {

constexpr double kRounding = 1e-9;  // of an interval: 3.0 / 0.3 is ten intervals, not eleven

void check_resampling(const TransferParameters& parameters) {
  if (!(parameters.pose_spacing > 0))
    throw std::invalid_argument("resample: pose_spacing " +
                                std::to_string(parameters.pose_spacing) + " is not above 0");
  if (parameters.max_poses_per_path < 0)
    throw std::invalid_argument("resample: max_poses_per_path " +
                                std::to_string(parameters.max_poses_per_path) + " is below 0");
  if (!(parameters.dropped_end_share >= 0 && parameters.dropped_end_share <= 0.5))
    throw std::invalid_argument("resample: dropped_end_share " +
                                std::to_string(parameters.dropped_end_share) +
                                " is not within 0 and 0.5");
}

/// Distance of each waypoint from the first along the path.
Eigen::VectorXd distances(const Eigen::MatrixXd& waypoints) {
  Eigen::VectorXd along = Eigen::VectorXd::Zero(waypoints.cols());
  for (Eigen::Index i = 1; i < waypoints.cols(); ++i)
    along[i] = along[i - 1] + (waypoints.col(i) - waypoints.col(i - 1)).norm();
  return along;
}

Eigen::Index count_poses(double length, const TransferParameters& parameters) {
  const double most = parameters.max_poses_per_path == 0
                          ? static_cast<double>(kMaxWaypoints)
                          : static_cast<double>(parameters.max_poses_per_path);
  const double wanted = std::ceil(length / parameters.pose_spacing - kRounding) + 1;
  return static_cast<Eigen::Index>(std::clamp(wanted, 1.0, most));
}

}  // namespace

Eigen::MatrixXd resample(const Path& path, const TransferParameters& parameters) {
  check_resampling(parameters);
  const Eigen::MatrixXd& waypoints = path.waypoints();
  const Eigen::VectorXd along = distances(waypoints);
  const double total = along[along.size() - 1];
  if (!std::isfinite(total))
    throw std::invalid_argument("resample: the length of the path is not finite");
  const double first = parameters.dropped_end_share * total;
  const double length = total - 2 * first;
  const Eigen::Index count = count_poses(length, parameters);

  Eigen::MatrixXd resampled(path.dof(), count);
  Eigen::Index segment = 0;  // between waypoints `segment` and `segment + 1`
  for (Eigen::Index i = 0; i < count; ++i) {
    const double share = count == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(count - 1);
    const double at = first + share * length;
    while (segment + 2 < along.size() && along[segment + 1] < at)
      ++segment;
    const double span = along[segment + 1] - along[segment];
    const double within = span > 0 ? std::clamp((at - along[segment]) / span, 0.0, 1.0) : 0.0;
    resampled.col(i) = (1 - within) * waypoints.col(segment) + within * waypoints.col(segment + 1);
  }
  return resampled;
}

}  // namespace kinship::kinematics
