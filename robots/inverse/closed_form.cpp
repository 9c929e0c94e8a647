#include "robots/inverse/closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kinship::inverse {
namespace {

constexpr std::size_t kJoints = 6;

/// "5-6-7": joints counted from 1, as people do.
std::string joint_range(int first, int second, int third) {
  return std::to_string(first + 1) + "-" + std::to_string(second + 1) + "-" +
         std::to_string(third + 1);
}

}  // namespace

double ClosedForm::deviation() const noexcept {
  return planar_ ? planar_->deviation() : six_->deviation;
}

std::string ClosedForm::structure_name() const {
  const std::string nearly = exact() ? "" : "nearly ";
  if (planar_)
    return nearly + "planar arm";
  const SixJointRule& rule = six_->rule;
  if (rule.kind == SixJointRule::Kind::ThreeParallel) {
    const std::size_t first = rule.reversed ? 2 : 1;
    return nearly + "parallel axes " +
           joint_range(free_[first], free_[first + 1], free_[first + 2]);
  }
  return rule.reversed ? nearly + "spherical shoulder " + joint_range(free_[0], free_[1], free_[2])
                       : nearly + "spherical wrist " + joint_range(free_[3], free_[4], free_[5]);
}

void ClosedForm::append(const Eigen::Isometry3d& T_base_transfer, std::span<const double> locked,
                        Branches& branches) const {
  const Displacement T{T_base_transfer.linear(), T_base_transfer.translation() / scale_m_};
  if (planar_)
    append_planar(T, locked, branches);
  else
    append_six(T, locked, branches);
}

void ClosedForm::append_six(const Displacement& T, std::span<const double> locked,
                            Branches& branches) const {
  std::array<double, kMaxLocked> values{};
  for (std::size_t i = 0; i < locks_.size(); ++i)
    values[i] = prismatic_[i] ? locked[i] / scale_m_ : locked[i];
  SixJointTask task;
  task.wanted = T * T_transfer_base_;
  task.slack = slack_;
  std::copy(windows_.begin(), windows_.end(), task.windows.begin());
  lock(six_->axes, locks_, values.data(), task);
  const SixJointBranches found = solve_six_joints(task, six_->rule);
  branches.leave_out(found.outside);
  for (int b = 0; b < found.count; ++b) {
    double* q = branches.add();
    if (q == nullptr)
      return;
    for (std::size_t i = 0; i < kJoints; ++i)
      q[free_[i]] = found.angles[static_cast<std::size_t>(b)][i];
    for (std::size_t i = 0; i < locks_.size(); ++i)
      q[locks_[i]] = locked[i];
  }
}

void ClosedForm::append_planar(const Displacement& T, std::span<const double> locked,
                               Branches& branches) const {
  std::array<double, kMaxDof> values;
  for (std::size_t i = 0; i < locks_.size(); ++i)
    values[static_cast<std::size_t>(locks_[i])] = locked[i];
  const PlanarBranches found = planar_->solve({free_, windows_, values.data(), slack_}, T);
  branches.leave_out(found.outside);
  for (int b = 0; b < found.count; ++b) {
    double* q = branches.add();
    if (q == nullptr)
      return;
    for (std::size_t i = 0; i < locks_.size(); ++i)
      q[locks_[i]] = locked[i];
    for (std::size_t i = 0; i < free_.size(); ++i)
      q[free_[i]] = found.angles[static_cast<std::size_t>(b)][i];
  }
}

}  // namespace kinship::inverse
