#include "robots/inverse/inverse.hpp"

#include "robots/inverse/solver.hpp"

namespace kinship::inverse {

InverseSolutions inverse(const kinematics::Chain& chain, const Eigen::Isometry3d& T_base_tip,
                         const InverseOptions& options) {
  return Solver(chain).solve(T_base_tip, options);
}

std::string solver_name(const kinematics::Chain& chain) { return Solver(chain).name(); }

}  // namespace kinship::inverse
