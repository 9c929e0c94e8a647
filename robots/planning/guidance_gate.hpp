#pragma once

#include <Eigen/Core>

#include "proto/types/mixture.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::planning {

/// A configuration beyond this squared Mahalanobis distance from every component of a mixture is
/// unrelated to the experience behind it.
inline constexpr double kGateDistance = 60;
/// Added to each variance before distances are measured, squared joint units: a narrow component is
/// no wall. With it kGateDistance was found not to fire on good distributions.
inline constexpr double kGateVariance = 0.05 * 0.05;

/// The mixture with kGateVariance added to each variance.
Mixture widened(const Mixture& mixture);

/// Distance of a query from a distribution: squared Mahalanobis distances to the nearest component,
/// dimensionless, its variances widened by kGateVariance.
struct QueryDistance {
  double start = 0;
  double goal = 0;  ///< of the nearest goal; infinite if there is none

  /// Whether the query should be planned uniformly: a mixture far from its start or goals says
  /// little about the configurations between.
  bool is_beyond(double limit) const noexcept { return start > limit || goal > limit; }
};

/// Joints wider than a turn count by the shorter way around.
/// \param start  dof.
/// \param goals  dof x n.
/// \throws std::invalid_argument if chain, mixture, start and goals differ in size.
/// \throws Failure(Internal) if a covariance is not positive definite.
QueryDistance query_distance(const kinematics::Chain& chain, const Mixture& mixture,
                             const Eigen::Ref<const Eigen::VectorXd>& start,
                             const Eigen::Ref<const Eigen::MatrixXd>& goals);

}  // namespace kinship::planning
