#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace ompl::base {
class RealVectorStateSpace;
class State;
}  // namespace ompl::base

namespace kinship::ompl_planners {

/// The configurations within bounds as a state space of OMPL: one real number per joint, Euclidean
/// distance in joint units. Joints do not wrap; planning_bounds chooses the turn.
/// \param bounds  2 x dof: lower, upper.
/// \throws std::invalid_argument if a bound is not finite or a lower one is not below its upper.
/// \return the space, shared by OMPL's planner, problem and states.
std::shared_ptr<ompl::base::RealVectorStateSpace> make_state_space(const Eigen::Matrix2Xd& bounds);

/// \param state  of a space from make_state_space with q.size() joints.
void copy_to_state(const Eigen::VectorXd& q, ompl::base::State& state);

/// \param state  of a space from make_state_space with `dof` joints.
Eigen::VectorXd to_configuration(const ompl::base::State& state, Eigen::Index dof);

/// Waypoints of a path of OMPL (PathGeometric::getStates()): dof x n.
Eigen::MatrixXd to_waypoints(const std::vector<ompl::base::State*>& states, Eigen::Index dof);

}  // namespace kinship::ompl_planners
