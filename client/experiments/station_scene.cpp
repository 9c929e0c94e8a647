#include "client/experiments/station_scene.hpp"

#include <utility>

namespace kinship::experiments {

Eigen::Isometry3d upright(double x, double y, double z, double yaw_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, z;
  T.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

Eigen::Isometry3d displaced(const Eigen::Vector3d& p, double deviation_m, double turn_rad,
                            Noise& noise) {
  const double dx = noise(deviation_m);
  const double dy = noise(deviation_m);
  return upright(p.x() + dx, p.y() + dy, p.z(), noise(turn_rad));
}

Eigen::Isometry3d looking_down() {
  Eigen::Isometry3d R = Eigen::Isometry3d::Identity();
  R.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return R;
}

void add_box(Scene& scene, std::string name, const Eigen::Vector3d& size,
             const Eigen::Isometry3d& T_task_object) {
  scene.objects.push_back({std::move(name), BoxShape{size}, T_task_object});
}

void add_table_top(Scene& scene, const Eigen::Vector2d& middle, const Eigen::Vector2d& size) {
  constexpr double kThick = 0.04;
  constexpr double kGap = 0.002;  // the top lies a little below z = 0
  add_box(scene, kTableName, {size.x(), size.y(), kThick},
          upright(middle.x(), middle.y(), -kThick / 2 - kGap));
}

}  // namespace kinship::experiments
