#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "robots/inverse/solver.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/planning/no_path.hpp"

namespace kinship::planning {

struct StartConfiguration {
  std::optional<Eigen::VectorXd> q;    ///< dof
  std::uint64_t collision_checks = 0;  ///< counted apart from the plan's
  NoPath reason = NoPath::None;        ///< why there is none
};

/// The start of a plan from a pose of the transfer frame: of the pose's free configurations the one
/// nearest to a goal configuration (Euclidean, 1 m = 1 rad; joints wider than a turn the shorter
/// way round). Without goal configurations, the one nearest to the middle of the joint limits (in
/// parts of each joint's range; continuous joints do not count): the goal is then a pose too, and
/// the plan may end in any of its configurations. Equal arguments, equal answer.
/// \param T_base_start  pose of the transfer frame in the base link, m.
/// \param goals         dof x n, n >= 0.
StartConfiguration start_configuration(const kinematics::Chain& chain,
                                       const inverse::Solver& solver,
                                       const Eigen::Isometry3d& T_base_start,
                                       const Eigen::MatrixXd& goals, const IsFree& is_free);

}  // namespace kinship::planning
