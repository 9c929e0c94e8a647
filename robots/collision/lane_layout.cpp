#include "robots/collision/lane_layout.hpp"

#include <algorithm>
#include <cstddef>

namespace kinship::collision {
namespace {

constexpr double kAlike = 1e-12;
constexpr std::size_t kTried = 4;  // axes of so many boxes

}  // namespace

bool is_of_quarter_turns(const Eigen::Matrix3d& R) {
  const Eigen::Array33d sizes = R.cwiseAbs().array();
  return (sizes < kAlike || (sizes - 1).abs() < kAlike).all();
}

Eigen::Matrix3d common_axes(const std::vector<Eigen::Matrix3d>& axes) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < std::min(kTried, axes.size()); ++i) {
    const std::ptrdiff_t alike =
        std::count_if(axes.begin(), axes.end(), [&](const Eigen::Matrix3d& other) {
          return is_of_quarter_turns(axes[i].transpose() * other);
        });
    if (alike > most) {
      most = alike;
      best = axes[i];
    }
  }
  return best;
}

}  // namespace kinship::collision
