#include "robots/inverse/planar_form.hpp"

#include <algorithm>
#include <numbers>

#include "robots/inverse/structure.hpp"
#include "robots/inverse/subproblems.hpp"

namespace kinship::inverse {

std::optional<PlanarForm> PlanarForm::of(const AxisChain& axes, const kinematics::Chain& chain) {
  const auto common = common_direction(axes);
  if (!common)
    return std::nullopt;
  Eigen::Index along = 0;
  common->direction.cwiseAbs().maxCoeff(&along);
  PlanarForm form;
  form.normal_ = Eigen::Vector3d::Unit(along);
  form.x_ = Eigen::Vector3d::Unit((along + 1) % 3);
  form.y_ = Eigen::Vector3d::Unit((along + 2) % 3);
  const double tilt = common->direction.cross(form.normal_).norm();
  const auto matters = [&](Eigen::Index axis) {
    return chain.task_axes().matters[static_cast<std::size_t>(axis)];
  };
  form.turn_matters_ = matters(3 + along);
  if (tilt > kNearStructure || !matters((along + 1) % 3) || !matters((along + 2) % 3) ||
      chain.dof() < form.free_joints())
    return std::nullopt;
  form.deviation_ = std::max(common->deviation, tilt);
  for (const Axis& axis : axes.axes) {
    form.joints_.push_back(form.in_plane(axis.point));
    form.signs_.push_back(axis.direction.dot(form.normal_) > 0 ? 1 : -1);
  }
  form.transfer_ = form.in_plane(axes.T_base_transfer.p);
  form.R_transfer_base_ = axes.T_base_transfer.R.transpose();
  return form;
}

/// The turn about the normal after which nothing of a rotation is left about it.
double PlanarForm::turn_of(const Eigen::Matrix3d& R) const {
  const Eigen::Vector3d twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return std::atan2(normal_.dot(twice_sine), R.trace() - normal_.dot(R * normal_));
}

PlanarBranches PlanarForm::solve(const std::vector<int>& free, const double* values,
                                 const Displacement& T, double slack) const {
  // Carried by the locked joints: z -> turn z + shift.
  Point turn = 1;
  Point shift = 0;
  std::array<Point, 3> at;
  std::size_t next = 0;
  double locked = 0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (next < free.size() && free[next] == static_cast<int>(j)) {
      at[next++] = turn * joints_[j] + shift;
      continue;
    }
    const double angle = signs_[j] * values[j];
    const Point by = std::polar(1.0, angle);
    shift += turn * (joints_[j] - by * joints_[j]);
    turn *= by;
    locked += angle;
  }
  const Point transfer = turn * transfer_ + shift;
  const Point wanted = in_plane(T.p);
  Point end = transfer;  // what the first two free joints have to bring to `goal`
  Point goal = wanted;
  double left = 0;
  if (turn_matters_) {
    left = turn_of(T.R * R_transfer_base_) - locked;
    end = at[2];
    goal = wanted + std::polar(1.0, left) * (at[2] - transfer);
  }
  const Point first = at[1] - at[0];
  const Point second = end - at[1];
  const Point hinge = std::conj(first) * second;
  const Turns folds =
      solve_cosine(hinge.real(), -hinge.imag(),
                   0.5 * (std::norm(goal - at[0]) - std::norm(first) - std::norm(second)), slack);
  PlanarBranches branches;
  for (const Turn& turn_between : folds) {
    const double fold = turn_between.angle();
    const Point reached = first + Point(turn_between.cosine, turn_between.sine) * second;
    const double swing = std::arg((goal - at[0]) * std::conj(reached));
    auto& q = branches.angles[static_cast<std::size_t>(branches.count++)];
    const auto sign = [&](std::size_t i) { return signs_[static_cast<std::size_t>(free[i])]; };
    q = {sign(0) * swing, sign(1) * fold, 0};
    if (turn_matters_)
      q[2] = sign(2) * std::remainder(left - swing - fold, 2 * std::numbers::pi);
  }
  return branches;
}

}  // namespace kinship::inverse
