#include "robots/inverse/planar_form.hpp"

#include <algorithm>

#include "robots/inverse/structure.hpp"
#include "robots/inverse/subproblems.hpp"

namespace kinship::inverse {
namespace {

using Point = std::complex<double>;

/// The product of two points: `*` without its care for infinities.
Point times(const Point& a, const Point& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// The turn from the real axis to a point; none for a point at the centre.
Turn direction_of(const Point& z) {
  const double length = std::sqrt(std::norm(z));
  return length > kSingular * kSingular ? Turn{z.real() / length, z.imag() / length} : Turn{};
}

}  // namespace

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
Turn PlanarForm::turn_of(const Eigen::Matrix3d& R) const {
  const Eigen::Vector3d twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return direction_of({R.trace() - normal_.dot(R * normal_), normal_.dot(twice_sine)});
}

PlanarBranches PlanarForm::solve(const PlanarTask& task, const Displacement& T) const {
  // Carried by the locked joints: z -> turn z + shift.
  Point turn = 1;
  Point shift = 0;
  std::array<Point, 3> at;
  std::size_t next = 0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (next < task.free.size() && task.free[next] == static_cast<int>(j)) {
      at[next++] = times(turn, joints_[j]) + shift;
      continue;
    }
    const Point by(std::cos(task.values[j]), signs_[j] * std::sin(task.values[j]));
    shift += times(turn, joints_[j] - times(by, joints_[j]));
    turn = times(turn, by);
  }
  const Point transfer = times(turn, transfer_) + shift;
  const Point wanted = in_plane(T.p);
  Point end = transfer;  // to be brought to `goal` by the first two free joints
  Point goal = wanted;
  Turn left;
  if (turn_matters_) {
    left = turn_of(T.R * R_transfer_base_) * Turn{turn.real(), -turn.imag()};
    end = at[2];
    goal = wanted + times({left.cosine, left.sine}, at[2] - transfer);
  }
  const Point first = at[1] - at[0];
  const Point second = end - at[1];
  const Point hinge = times(std::conj(first), second);
  const Turns folds = solve_cosine(
      hinge.real(), -hinge.imag(),
      0.5 * (std::norm(goal - at[0]) - std::norm(first) - std::norm(second)), task.slack);
  PlanarBranches branches;
  for (const Turn& fold : folds) {
    const Point reached = first + times({fold.cosine, fold.sine}, second);
    const Turn swing = direction_of(times(goal - at[0], std::conj(reached)));
    std::array<Turn, 3> turns = {swing, fold, left * swing.back() * fold.back()};
    bool inside = true;
    for (std::size_t i = 0; i < task.free.size(); ++i) {
      if (signs_[static_cast<std::size_t>(task.free[i])] < 0)
        turns[i] = turns[i].back();
      inside = inside && task.windows[i].holds(turns[i]);
    }
    branches.outside = branches.outside || !inside;
    if (!inside)
      continue;
    auto& q = branches.angles[static_cast<std::size_t>(branches.count++)];
    for (std::size_t i = 0; i < task.free.size(); ++i)
      q[i] = turns[i].angle();
  }
  return branches;
}

}  // namespace kinship::inverse
