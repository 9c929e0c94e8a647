#include "robots/inverse/wrist_reach.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "robots/inverse/axis.hpp"
#include "robots/inverse/descent.hpp"

namespace kinship::inverse {
namespace {

/// Points, one on each axis, at joints at 0. Two neighbours lie on one link: their distance is that
/// in every configuration.
class LinkPoints {
 public:
  explicit LinkPoints(const std::vector<Axis>& axes)
      : axes_(axes), along_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(axes.size()))) {}

  Eigen::Vector3d point(std::size_t i) const {
    return axes_[i].point + along_[static_cast<Eigen::Index>(i)] * axes_[i].direction;
  }
  double length(std::size_t link) const { return (point(link + 1) - point(link)).norm(); }
  double total_length() const {
    double sum = 0;
    for (std::size_t link = 0; link + 1 < axes_.size(); ++link)
      sum += length(link);
    return sum;
  }

  /// Moves the points along their axes so that the sum of distances gets less, wherever it may end:
  /// any points give a bound. Iteratively reweighted least squares.
  /// Source: Weiszfeld, Tohoku Mathematical Journal 43 (1937).
  void shorten() {
    constexpr int kSteps = 100;
    constexpr double kLeastLength = 1e-4, kDamping = 1e-9;  // shares of the arm's size
    const Eigen::Index count = along_.size();
    for (int step = 0; step < kSteps; ++step) {
      Eigen::MatrixXd system = kDamping * Eigen::MatrixXd::Identity(count, count);
      Eigen::VectorXd wanted = kDamping * along_;
      for (std::size_t i = 0; i + 1 < axes_.size(); ++i) {
        const Axis &a = axes_[i], &b = axes_[i + 1];
        const double weight = 1 / std::max(length(i), kLeastLength);
        const auto row = static_cast<Eigen::Index>(i);
        const Eigen::Vector3d between = b.point - a.point;
        system(row, row) += weight;
        system(row + 1, row + 1) += weight;
        system(row, row + 1) -= weight * a.direction.dot(b.direction);
        system(row + 1, row) = system(row, row + 1);
        wanted[row] += weight * between.dot(a.direction);
        wanted[row + 1] -= weight * between.dot(b.direction);
      }
      along_ = system.ldlt().solve(wanted);
    }
  }

 private:
  const std::vector<Axis>& axes_;
  Eigen::VectorXd along_;  // from each axis' point
};

}  // namespace

std::optional<WristReach> WristReach::of(const kinematics::Chain& chain) {
  const AxisChain arm = axes_of(chain);
  if (!chain.task_axes().all() || arm.axes.size() < 2 ||
      std::ranges::any_of(arm.axes, &Axis::prismatic))
    return std::nullopt;
  LinkPoints points(arm.axes);
  points.shorten();
  WristReach reach;
  reach.p_base_shoulder_ = arm.scale_m * points.point(0);
  reach.p_transfer_wrist_ =
      arm.scale_m * arm.T_base_transfer.inverse()(points.point(arm.axes.size() - 1));
  // Room for the tolerance of a pose and for rounding.
  const double slack_m = 4 * kPoseTolerance * (1 + reach.p_transfer_wrist_.norm());
  reach.reach_m_ = arm.scale_m * points.total_length() + slack_m;
  if (!(reach.reach_m_ > 0) || !reach.p_transfer_wrist_.allFinite())
    return std::nullopt;
  return reach;
}

}  // namespace kinship::inverse
