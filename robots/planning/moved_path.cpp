#include "robots/planning/moved_path.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kinship::planning {
namespace {

constexpr double kRadian_m = 0.3;
constexpr double kAllGoals = 0.5;  // share of the path after which it moves with the goal alone

/// Between two poses: a at 0, b at 1.
Eigen::Isometry3d blended(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double weight) {
  const Eigen::Quaterniond from(a.linear());
  Eigen::Quaterniond to(b.linear());
  if (from.dot(to) < 0)
    to.coeffs() *= -1;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond((1 - weight) * from.coeffs() + weight * to.coeffs())
                      .normalized()
                      .toRotationMatrix();
  pose.translation() = (1 - weight) * a.translation() + weight * b.translation();
  return pose;
}

}  // namespace

double pose_distance_m(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const double cosine = ((a.linear().transpose() * b.linear()).trace() - 1) / 2;
  return (a.translation() - b.translation()).norm() +
         kRadian_m * std::acos(std::clamp(cosine, -1.0, 1.0));
}

PosePath retreat(double distance_m) {
  constexpr double kRetreating = 0.5;  // share of the path
  PosePath path;
  for (int i = 0; i < kExperiencePoses; ++i) {
    const double left = 1 - i / (kExperiencePoses - 1.0);
    path.poses.emplace_back(
        Eigen::Translation3d(0, 0, -distance_m * std::min(left / kRetreating, 1.0)));
  }
  return path;
}

std::vector<std::size_t> nearest_paths(const std::vector<PosePath>& paths, const PoseQuery& query,
                                       std::size_t count) {
  std::vector<double> distances(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i)
    distances[i] = pose_distance_m(paths[i].poses.back(), query.T_task_goal) +
                   pose_distance_m(paths[i].poses.front(), query.T_task_start);
  std::vector<std::size_t> order(paths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto kept = static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::ranges::partial_sort(order, order.begin() + kept, [&](std::size_t a, std::size_t b) {
    return distances[a] != distances[b] ? distances[a] < distances[b] : a < b;
  });
  order.resize(static_cast<std::size_t>(kept));
  return order;
}

std::vector<Eigen::Isometry3d> moved_onto(const PosePath& path, const PoseQuery& query) {
  const Eigen::Isometry3d by_start = query.T_task_start * path.poses.front().inverse();
  const Eigen::Isometry3d by_goal = query.T_task_goal * path.poses.back().inverse();
  std::vector<Eigen::Isometry3d> moved;
  moved.reserve(path.poses.size());
  const double last = static_cast<double>(path.poses.size()) - 1;
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    const double share = static_cast<double>(i) / last;
    moved.push_back(blended(by_start * path.poses[i], by_goal * path.poses[i],
                            std::min(share / kAllGoals, 1.0)));
  }
  return moved;
}

}  // namespace kinship::planning
