#include "client/ompl/state_space.hpp"

#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <algorithm>
#include <stdexcept>

namespace kinship::ompl_planners {
namespace {

using RealVectorState = ompl::base::RealVectorStateSpace::StateType;

}  // namespace

std::shared_ptr<ompl::base::RealVectorStateSpace> make_state_space(const Eigen::Matrix2Xd& bounds) {
  if (bounds.cols() < 1 || !bounds.allFinite() ||
      (bounds.row(0).array() >= bounds.row(1).array()).any())
    throw std::invalid_argument("make_state_space: bounds are not finite or crossed");
  const auto dof = static_cast<unsigned int>(bounds.cols());
  auto space = std::make_shared<ompl::base::RealVectorStateSpace>(dof);
  ompl::base::RealVectorBounds limits(dof);
  for (unsigned int i = 0; i < dof; ++i) {
    limits.setLow(i, bounds(0, i));
    limits.setHigh(i, bounds(1, i));
  }
  space->setBounds(limits);
  return space;
}

void copy_to_state(const Eigen::VectorXd& q, ompl::base::State& state) {
  std::copy(q.begin(), q.end(), state.as<RealVectorState>()->values);
}

Eigen::VectorXd to_configuration(const ompl::base::State& state, Eigen::Index dof) {
  return Eigen::Map<const Eigen::VectorXd>(state.as<RealVectorState>()->values, dof);
}

Eigen::MatrixXd to_waypoints(const std::vector<ompl::base::State*>& states, Eigen::Index dof) {
  Eigen::MatrixXd waypoints(dof, static_cast<Eigen::Index>(states.size()));
  for (std::size_t i = 0; i < states.size(); ++i)
    waypoints.col(static_cast<Eigen::Index>(i)) = to_configuration(*states[i], dof);
  return waypoints;
}

}  // namespace kinship::ompl_planners
