#include "robots/inverse/task_rank.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>

#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/lane_chain.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::inverse {
namespace {

constexpr int kRankTrials = 8;  // a singular one among them does no harm

/// Singular value, lengths in units of the arm's: a smaller one is lost in the damping of a step,
/// whose root is 3e-4, and a quarter of a turn that is written as 1.57 is off by 8e-4.
constexpr double kUnseen = 1e-3;

Eigen::Index axis_count(const kinematics::Chain& chain) {
  return std::ranges::count(chain.task_axes().matters, true);
}

/// Motions of the transfer frame by the joints at random configurations, lengths in units of the
/// arm's.
class Directions {
 public:
  explicit Directions(const kinematics::Chain& chain) : axes_(axis_count(chain)) {
    const double length_m = lane_chain(chain).length_m;
    CounterGenerator generator(1);
    for (kinematics::Jacobian& J : at_) {
      Eigen::VectorXd q(chain.dof());
      for (Eigen::Index j = 0; j < q.size(); ++j)
        q[j] = chain.lower()[j] + generator.uniform() * (chain.upper()[j] - chain.lower()[j]);
      J = task_jacobian(chain, q);
      for (Eigen::Index j = 0; j < J.cols(); ++j)
        if (chain.joints()[static_cast<std::size_t>(j)].type != kinematics::JointType::Prismatic)
          J.col(j).head<3>() /= length_m;
    }
  }

  /// Of `count` joints from `first` on, at the best of them.
  Eigen::Index rank(Eigen::Index first, Eigen::Index count) const {
    Eigen::Index best = 0;
    for (const kinematics::Jacobian& J : at_) {
      const Eigen::MatrixXd of_joints = J.middleCols(first, count);
      const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(of_joints).singularValues();
      best = std::max<Eigen::Index>(best, (values.array() > kUnseen).count());
      if (best == std::min(count, axes_))
        break;
    }
    return best;
  }

 private:
  Eigen::Index axes_;
  std::array<kinematics::Jacobian, kRankTrials> at_;
};

}  // namespace

kinematics::Jacobian task_jacobian(const kinematics::Chain& chain,
                                   const Eigen::Ref<const Eigen::VectorXd>& q) {
  kinematics::Jacobian J = kinematics::J_base_tip(chain, q);
  // The transfer frame is fixed to the tip: its velocity is the tip's and the turn's share.
  const Eigen::Vector3d p_tip_transfer =
      kinematics::T_base_tip(chain, q).linear() * chain.T_tip_transfer().translation();
  for (Eigen::Index j = 0; j < J.cols(); ++j) {
    const Eigen::Vector3d turn = J.col(j).tail<3>();
    J.col(j).head<3>() += turn.cross(p_tip_transfer);
  }
  for (Eigen::Index row = 0; row < J.rows(); ++row)
    if (!chain.task_axes().matters[static_cast<std::size_t>(row)])
      J.row(row).setZero();
  return J;
}

Eigen::Index task_rank(const kinematics::Chain& chain) {
  return Directions(chain).rank(0, chain.dof());
}

bool is_redundant(const kinematics::Chain& chain) {
  return chain.dof() > axis_count(chain) || chain.dof() > task_rank(chain);
}

bool has_repeated_joints(const kinematics::Chain& chain) {
  const Directions directions(chain);
  for (Eigen::Index count = 2; count <= std::min(chain.dof(), axis_count(chain)); ++count)
    for (Eigen::Index first = 0; first + count <= chain.dof(); ++first)
      if (directions.rank(first, count) < count)
        return true;
  return false;
}

}  // namespace kinship::inverse
