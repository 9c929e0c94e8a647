#include "robots/inverse/descent.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "proto/types/turn.hpp"
#include "robots/inverse/task_rank.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/joint_motion.hpp"

namespace kinship::inverse {
namespace {

constexpr double kDampingShare = 0.05;  // of the squared error
constexpr double kSmallestDamping = 1e-7;
constexpr double kLargestStep = 1.0;   // joint units per iteration
constexpr double kSteeringGain = 0.5;  // share of the way to mid-range per iteration
constexpr double kDone = 1e-20;        // squared error: far below the verification's

/// 2 sin(angle / 2) times the axis of a rotation.
Eigen::Vector3d rotation_error(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond quaternion(R);
  return (quaternion.w() < 0 ? -2.0 : 2.0) * quaternion.vec();
}

void drop_free_axes(const TaskAxes& axes, TaskError& error) {
  for (std::size_t i = 0; i < axes.matters.size(); ++i)
    if (!axes.matters[i])
      error[static_cast<Eigen::Index>(i)] = 0;
}

}  // namespace

TaskError task_error(const Eigen::Isometry3d& T_base_wanted, const Eigen::Isometry3d& T_base_actual,
                     const TaskAxes& axes) {
  TaskError error;
  error << T_base_wanted.translation() - T_base_actual.translation(),
      rotation_error(T_base_wanted.linear() * T_base_actual.linear().transpose());
  drop_free_axes(axes, error);
  return error;
}

bool reaches(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_transfer,
             const Eigen::Ref<const Eigen::VectorXd>& q) {
  const TaskError error =
      task_error(T_base_transfer, kinematics::T_base_transfer(chain, q), chain.task_axes());
  return error.head<3>().norm() <= kPoseTolerance && error.tail<3>().norm() <= kPoseTolerance;
}

Descent::Descent(const kinematics::Chain& chain) : axes_(chain.task_axes()) {
  Eigen::Isometry3d T_turned_moving = Eigen::Isometry3d::Identity();  // of the joint before
  for (const kinematics::Joint& joint : chain.joints()) {
    Eigen::Isometry3d T_joint_turned = Eigen::Isometry3d::Identity();
    T_joint_turned.linear() = kinematics::rotation_of_z_to(joint.axis);
    const Eigen::Isometry3d T_previous_turned =
        T_turned_moving * joint.T_previous_joint * T_joint_turned;
    Step step;
    step.R = T_previous_turned.linear();
    step.p = T_previous_turned.translation();
    step.prismatic = joint.type == kinematics::JointType::Prismatic;
    step.bounded = step.prismatic || (joint.type == kinematics::JointType::Revolute &&
                                      joint.upper - joint.lower < kTurn);
    step.lower = joint.lower;
    step.upper = joint.upper;
    steps_.push_back(step);
    T_turned_moving = T_joint_turned.inverse();
  }
  const Eigen::Isometry3d T_last_transfer =
      T_turned_moving * chain.T_last_tip() * chain.T_tip_transfer();
  R_last_transfer_ = T_last_transfer.linear();
  p_last_transfer_ = T_last_transfer.translation();
  redundant_ = is_redundant(chain);
}

TaskError Descent::error_and_jacobian(const Eigen::Isometry3d& T_base_transfer,
                                      const JointVector& q, TaskJacobian& J_base_transfer) const {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < steps_.size(); ++j) {
    const Step& step = steps_[j];
    const auto column = static_cast<Eigen::Index>(j);
    p += R * step.p;
    R = (R * step.R).eval();
    // Above: the joint's origin for now. Below: its axis.
    J_base_transfer.col(column) << p, R.col(2);
    if (step.prismatic) {
      p += q[column] * R.col(2);
      continue;
    }
    const double c = std::cos(q[column]);
    const double s = std::sin(q[column]);
    const Eigen::Vector3d x = R.col(0);
    const Eigen::Vector3d y = R.col(1);
    R.col(0) = c * x + s * y;
    R.col(1) = c * y - s * x;
  }
  p += R * p_last_transfer_;
  R = (R * R_last_transfer_).eval();

  for (std::size_t j = 0; j < steps_.size(); ++j) {
    auto column = J_base_transfer.col(static_cast<Eigen::Index>(j));
    const Eigen::Vector3d axis = column.tail<3>();
    if (steps_[j].prismatic)
      column << axis, Eigen::Vector3d::Zero();
    else
      column.head<3>() = axis.cross(p - column.head<3>());
  }
  TaskError error;
  error << T_base_transfer.translation() - p,
      rotation_error(T_base_transfer.linear() * R.transpose());
  for (Eigen::Index row = 0; row < 6; ++row) {
    if (axes_.matters[static_cast<std::size_t>(row)])
      continue;
    error[row] = 0;
    J_base_transfer.row(row).setZero();
  }
  return error;
}

bool Descent::steer(const JointVector& q, JointVector& pull) const {
  bool outside = false;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Step& step = steps_[static_cast<std::size_t>(j)];
    const double half = 0.5 * (step.upper - step.lower);
    double off_middle = q[j] - 0.5 * (step.lower + step.upper);
    if (!step.prismatic && std::abs(off_middle) > half)
      off_middle = wrapped(off_middle);
    const bool pulled = step.bounded && std::abs(off_middle) > half;
    pull[j] = pulled ? -kSteeringGain * off_middle : 0;
    outside = outside || pulled;
  }
  return outside;
}

void Descent::hold(const JointVector& q, const TaskError& error,
                   TaskJacobian& J_base_transfer) const {
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const Step& step = steps_[static_cast<std::size_t>(j)];
    if (!step.bounded || (q[j] > step.lower && q[j] < step.upper))
      continue;
    const double push = J_base_transfer.col(j).dot(error);
    if ((push < 0 && q[j] <= step.lower) || (push > 0 && q[j] >= step.upper))
      J_base_transfer.col(j).setZero();
  }
}

void Descent::clamp_to_limits(JointVector& q) const {
  for (Eigen::Index j = 0; j < q.size(); ++j)
    if (const Step& step = steps_[static_cast<std::size_t>(j)]; step.bounded)
      q[j] = std::clamp(q[j], step.lower, step.upper);
}

double Descent::run(const Eigen::Isometry3d& T_base_transfer, Limits limits, int max_iterations,
                    JointVector& q) const {
  const bool steering = redundant_ && limits == Limits::Steer;
  TaskJacobian jacobian(6, q.size());
  JointVector pull = JointVector::Zero(q.size());
  for (int iteration = 0;; ++iteration) {
    const TaskError error = error_and_jacobian(T_base_transfer, q, jacobian);
    const double squared = error.squaredNorm();
    const bool outside = steering && steer(q, pull);
    if ((squared < kDone && !outside) || iteration == max_iterations)
      return squared;
    if (limits == Limits::Hold)
      hold(q, error, jacobian);

    Eigen::Matrix<double, 6, 6> system = Eigen::Matrix<double, 6, 6>::Zero();
    system.diagonal().setConstant(kDampingShare * squared + kSmallestDamping);
    TaskError wanted = error;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      system.noalias() += jacobian.col(j) * jacobian.col(j).transpose();
      wanted -= pull[j] * jacobian.col(j);  // the pull may use only freedom beside the task
    }
    const TaskError y = system.llt().solve(wanted);
    for (Eigen::Index j = 0; j < q.size(); ++j)
      q[j] += std::clamp(jacobian.col(j).dot(y) + pull[j], -kLargestStep, kLargestStep);
    if (limits == Limits::Hold)
      clamp_to_limits(q);
  }
}

}  // namespace kinship::inverse
