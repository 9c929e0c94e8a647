#include "robots/inverse/solver.hpp"

#include <stdexcept>
#include <utility>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/elimination.hpp"
#include "robots/inverse/search.hpp"
#include "robots/inverse/task_rank.hpp"

namespace kinship::inverse {

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

}  // namespace kinship::inverse
