#include "robots/inverse/solver.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "robots/inverse/axis.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/inverse/elimination.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/inverse/search.hpp"
#include "robots/inverse/task_rank.hpp"

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

Solver::Solver(const kinematics::Chain& chain) : Solver(chain, instruction_sets().back().kernels) {}

Solver::Solver(const kinematics::Chain& chain, const SimdKernels& kernels, Engines engines)
    : kernels_(kernels),
      lanes_(lane_chain(chain)),
      arm_(lane_arm(chain)),
      space_(chain),
      redundant_(is_redundant(chain)),
      repeats_joints_(redundant_ && has_repeated_joints(chain)),
      T_tip_transfer_(chain.T_tip_transfer()),
      reach_m_(inverse::reach_m(chain)),
      wrist_reach_(WristReach::of(chain)),
      p_base_first_joint_(chain.joints().front().T_previous_joint.translation()) {
  if (engines == Engines::Descents)
    return;
  ClosedFormFinding finding = find_closed_form(chain);
  closed_ = std::move(finding.form);
  if (engines == Engines::ClosedForm && !closed_)
    closed_ = std::move(finding.left_out);
  if (engines == Engines::Best && !closed_)
    elimination_ = elimination_of(chain, lanes_, kernels_);
}

bool Solver::beyond_reach(const Eigen::Isometry3d& T_base_transfer) const {
  Eigen::Vector3d p = T_base_transfer.translation() - p_base_first_joint_;
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    p[axis] *= arm_.matters[axis];
  return p.norm() > reach_m_ + kPoseTolerance ||
         (wrist_reach_ && wrist_reach_->is_beyond(T_base_transfer));
}

InverseSolutions Solver::solve(const Eigen::Isometry3d& T_base_tip,
                               const InverseOptions& options) const {
  if (!T_base_tip.matrix().allFinite())
    throw std::invalid_argument("inverse: the pose of the tip link is not finite");
  if (options.max_solutions < 0)
    throw std::invalid_argument("inverse: max_solutions must not be negative");
  if (!(options.min_distance >= 0))
    throw std::invalid_argument("inverse: min_distance must be 0 or more");
  return Search(*this, T_base_tip, options).run();
}

std::string Solver::name() const {
  if (closed_)
    return "closed form and Levenberg-Marquardt";
  return elimination_ ? "elimination and Levenberg-Marquardt" : "multi-start Levenberg-Marquardt";
}

InverseSolutions inverse(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip,
                         const InverseOptions& options) {
  return Solver(chain).solve(T_base_tip, options);
}

std::string solver_name(const kinematics::Chain& chain) { return Solver(chain).name(); }

}  // namespace kinship::inverse
