#include "robots/inverse/unreached.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/turn.hpp"
#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/inverse/task_rank.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::inverse {
namespace {

using kinematics::Chain;
using kinematics::JointType;

constexpr int kPlaceAxes = 3;  // x, y, z; the rest turn
constexpr InverseOptions kMany{.max_solutions = 32};
constexpr int kNearingStarts = 16;
constexpr int kNearingSteps = 100;
constexpr int kTurningSteps = 60;
constexpr double kLargestTurn = 0.3;        // joint units a step
constexpr double kTurnDampingShare = 0.05;  // of the squared error of the orientation
constexpr double kSmallestTurnDamping = 1e-9;
constexpr double kSameDirection = 1e-6;  // singular values of the place's rows

Chain with_axes(const Chain& chain, const TaskAxes& axes) {
  kinematics::ChainParts parts = chain.parts();
  parts.task_axes = axes;
  return Chain(std::move(parts));
}

bool has_room_beyond(const kinematics::Joint& joint) {
  return joint.type == JointType::Prismatic ||
         (joint.type == JointType::Revolute && joint.upper - joint.lower < kTurn);
}

/// A turning joint may go all the way round, a sliding one farther by `more_m` at both ends.
void widen(double more_m, kinematics::Joint& joint) {
  if (!has_room_beyond(joint))
    return;
  const bool slides = joint.type == JointType::Prismatic;
  const double middle = 0.5 * (joint.lower + joint.upper);
  joint.lower =
      slides ? std::max(joint.lower - more_m, -kMaxPlacement_m) : middle - std::numbers::pi;
  joint.upper =
      slides ? std::min(joint.upper + more_m, kMaxPlacement_m) : middle + std::numbers::pi;
}

std::vector<JointBeyond> joints_beyond(const Chain& chain,
                                       const Eigen::Ref<const Eigen::VectorXd>& q) {
  std::vector<JointBeyond> beyond;
  for (std::size_t j = 0; j < chain.joints().size(); ++j) {
    const double value = q[static_cast<Eigen::Index>(j)];
    const double limit = std::clamp(value, chain.joints()[j].lower, chain.joints()[j].upper);
    if (has_room_beyond(chain.joints()[j]) && value != limit)
      beyond.push_back({j, value, limit});
  }
  return beyond;
}

double excess(const std::vector<JointBeyond>& beyond) {
  double sum = 0;
  for (const JointBeyond& joint : beyond)
    sum += std::abs(joint.value - joint.limit);
  return sum;
}

/// Takes `other` if it has fewer joints beyond their limits, or as many by less.
void take_better(std::vector<JointBeyond> other, std::vector<JointBeyond>& best) {
  if (other.empty())
    return;
  if (best.empty() || other.size() < best.size() ||
      (other.size() == best.size() && excess(other) < excess(best)))
    best = std::move(other);
}

/// Which limits would have to be wider.
std::vector<JointBeyond> find_beyond(const Chain& chain, const Eigen::Isometry3d& T_base_tip) {
  const double more_m =
      (T_base_tip.translation() - chain.joints().front().T_previous_joint.translation()).norm() +
      reach_m(chain);
  std::vector<JointBeyond> best;
  const auto look = [&](kinematics::ChainParts parts) {
    const auto found = Solver(Chain(std::move(parts))).solve(T_base_tip, kMany);
    for (const auto& q : found.configurations.colwise())
      take_better(joints_beyond(chain, q), best);
    return found.configurations.cols() > 0;
  };
  kinematics::ChainParts all = chain.parts();
  for (kinematics::Joint& joint : all.joints)
    widen(more_m, joint);
  if (!look(std::move(all)))
    return {};
  for (std::size_t j = 0; j < chain.joints().size(); ++j) {
    kinematics::ChainParts one = chain.parts();
    widen(more_m, one.joints[j]);
    if (has_room_beyond(chain.joints()[j]))
      look(std::move(one));
  }
  return best;
}

/// How near the transfer frame comes to the place within limits, m. Descents aim no farther than
/// the arm is long: a step overshoots where the error is many times that.
double find_distance_m(const Chain& placed, const Eigen::Isometry3d& T_base_transfer) {
  const Descent descent(placed);
  const JointSpace space(placed);
  const Eigen::Vector3d p_first = placed.joints().front().T_previous_joint.translation();
  const Eigen::Vector3d away = T_base_transfer.translation() - p_first;
  Eigen::Isometry3d T_base_aim = T_base_transfer;
  T_base_aim.translation() =
      p_first + away * std::min(1.0, reach_m(placed) / std::max(away.norm(), kPoseTolerance));
  double least = std::numeric_limits<double>::infinity();
  for (std::uint64_t start = 0; start < kNearingStarts; ++start) {
    CounterGenerator generator(start);
    JointVector q(placed.dof());
    for (Eigen::Index j = 0; j < q.size(); ++j)
      q[j] =
          std::clamp(space.value_at(j, generator.uniform()), placed.lower()[j], placed.upper()[j]);
    descent.run(T_base_aim, Descent::Limits::Hold, kNearingSteps, q);
    const TaskError error =
        task_error(T_base_transfer, kinematics::T_base_transfer(placed, q), placed.task_axes());
    least = std::min(least, error.norm());
  }
  return least;
}

/// Towards the place, and with the freedom left by that towards the orientation.
/// Source: Nakamura, Hanafusa, Yoshikawa, Task-priority based redundancy control of robot
/// manipulators, International Journal of Robotics Research 6 (1987), eq. 11.
Eigen::VectorXd place_then_turn(const kinematics::Jacobian& J, const TaskError& error) {
  const Eigen::MatrixXd J_place = J.topRows<3>();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> place;
  place.setThreshold(kSameDirection);
  place.compute(J_place);
  const Eigen::MatrixXd inverse = place.pseudoInverse();
  const Eigen::VectorXd step = inverse * error.head<3>();
  const Eigen::MatrixXd free = Eigen::MatrixXd::Identity(J.cols(), J.cols()) - inverse * J_place;
  const Eigen::MatrixXd J_turn = J.bottomRows<3>() * free;
  const Eigen::Vector3d turn = error.tail<3>() - J.bottomRows<3>() * step;
  Eigen::Matrix3d system = J_turn * J_turn.transpose();
  system.diagonal().array() += kTurnDampingShare * turn.squaredNorm() + kSmallestTurnDamping;
  return step + J_turn.transpose() * system.ldlt().solve(turn);
}

/// The least angle to the orientation on a way that leads from a configuration at the place, rad.
double least_turn(const Chain& chain, const Eigen::Isometry3d& T_base_transfer, Eigen::VectorXd q) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTurningSteps; ++i) {
    const TaskError error =
        task_error(T_base_transfer, kinematics::T_base_transfer(chain, q), chain.task_axes());
    if (error.head<3>().norm() <= kPoseTolerance)
      least = std::min(least, 2 * std::asin(std::min(1.0, 0.5 * error.tail<3>().norm())));
    kinematics::Jacobian J = task_jacobian(chain, q);
    Eigen::VectorXd step;
    for (bool held = true; held;) {  // joints at a limit that the step would push across
      step = place_then_turn(J, error);
      held = false;
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        const bool pushed = has_room_beyond(chain.joints()[static_cast<std::size_t>(j)]) &&
                            ((step[j] < 0 && q[j] <= chain.lower()[j]) ||
                             (step[j] > 0 && q[j] >= chain.upper()[j]));
        held = held || pushed;
        if (pushed)
          J.col(j).setZero();
      }
    }
    q += step * std::min(1.0, kLargestTurn / std::max(kLargestTurn, step.cwiseAbs().maxCoeff()));
    for (Eigen::Index j = 0; j < q.size(); ++j)
      if (has_room_beyond(chain.joints()[static_cast<std::size_t>(j)]))
        q[j] = std::clamp(q[j], chain.lower()[j], chain.upper()[j]);
  }
  return least;
}

/// Task axes as bits, x the lowest.
unsigned bits_of(const TaskAxes& axes) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < axes.matters.size(); ++i)
    bits |= axes.matters[i] ? 1U << i : 0U;
  return bits;
}

TaskAxes axes_of_bits(unsigned bits) {
  TaskAxes axes;
  for (std::size_t i = 0; i < axes.matters.size(); ++i)
    axes.matters[i] = (bits >> i & 1U) != 0;
  return axes;
}

/// The most of the requested axes with which the pose is reached; yaw is the first to go.
/// \param kept    must be among them.
/// \param fewest  no fewer.
std::optional<TaskAxes> find_axes(const Chain& chain, const Eigen::Isometry3d& T_base_tip,
                                  unsigned kept, int fewest) {
  const unsigned asked = bits_of(chain.task_axes());
  for (int count = std::popcount(asked) - 1; count >= std::max(fewest, 1); --count)
    for (unsigned bits = 1; bits < asked; ++bits)
      if (std::popcount(bits) == count && (bits & ~asked) == 0 && (kept & ~bits) == 0 &&
          Solver(with_axes(chain, axes_of_bits(bits)))
                  .solve(T_base_tip, {.max_solutions = 1})
                  .configurations.cols() > 0)
        return axes_of_bits(bits);
  return std::nullopt;
}

std::string measure_text(const char* format, double value) {
  std::array<char, 32> written{};
  std::snprintf(written.data(), written.size(), format, value);
  return written.data();
}

std::string beyond_text(const JointBeyond& beyond, const Chain& chain) {
  const kinematics::Joint& joint = chain.joints()[beyond.joint];
  const std::string unit = joint.type == JointType::Prismatic ? " m" : " rad";
  return "joint '" + joint.name + "' would have to go to " + measure_text("%.4g", beyond.value) +
         unit + " (" + measure_text("%.2g", std::abs(beyond.value - beyond.limit)) + unit +
         " beyond its limit)";
}

}  // namespace

Unreached find_unreached(const Chain& chain, const Eigen::Isometry3d& T_base_tip) {
  Unreached unreached;
  unreached.beyond = find_beyond(chain, T_base_tip);
  const unsigned asked = bits_of(chain.task_axes());
  const unsigned place = asked & ((1U << kPlaceAxes) - 1);
  if (place == 0)
    return unreached;
  const Eigen::Isometry3d T_base_transfer = T_base_tip * chain.T_tip_transfer();
  const Chain placed = with_axes(chain, axes_of_bits(place));
  const auto there = place == asked ? InverseSolutions{} : Solver(placed).solve(T_base_tip, kMany);
  if (there.configurations.cols() == 0) {
    unreached.distance_m = find_distance_m(placed, T_base_transfer);
    // Axes that the joints cannot serve at all may be the reason.
    const Eigen::Index rank = task_rank(chain);
    if (unreached.beyond.empty() && rank < std::popcount(asked))
      unreached.axes = find_axes(chain, T_base_tip, 0, static_cast<int>(rank));
    return unreached;
  }
  double least = std::numeric_limits<double>::infinity();
  for (const auto& q : there.configurations.colwise())
    least = std::min(least, least_turn(chain, T_base_transfer, q));
  unreached.angle_rad = least;
  unreached.axes = find_axes(chain, T_base_tip, place, std::popcount(place));
  return unreached;
}

std::string describe(const Unreached& unreached, const Chain& chain) {
  std::string said;
  for (const JointBeyond& beyond : unreached.beyond)
    said += (said.empty() ? "" : " and ") + beyond_text(beyond, chain);
  const auto add = [&](const std::string& part) { said += (said.empty() ? "" : "; ") + part; };
  if (unreached.distance_m && *unreached.distance_m > kPoseTolerance)
    add("its place is out of reach by " + measure_text("%.2g", *unreached.distance_m) + " m");
  if (unreached.angle_rad && *unreached.angle_rad > kPoseTolerance)
    add("its place is in reach, its orientation is not, by " +
        measure_text("%.2g", *unreached.angle_rad) + " rad");
  if (!unreached.axes)
    return said;
  std::string names;
  for (std::size_t i = 0; i < kTaskAxisNames.size(); ++i)
    if (unreached.axes->matters[i])
      names += (names.empty() ? "" : ",") + std::string(kTaskAxisNames[i]);
  add("with --axes " + names + " it is reached");
  return said;
}

}  // namespace kinship::inverse
