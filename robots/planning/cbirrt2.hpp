#pragma once

#include <Eigen/Core>
#include <random>

#include "robots/planning/birrt.hpp"
#include "robots/planning/region_constraint.hpp"

namespace kinship::planning {

/// The conditions on the configurations of a constrained plan; borrows both.
struct ConstrainedFreedom {
  const IsFree& is_free;
  RegionConstraint& constraint;  ///< its bounds are those of the sampler; counts the projections
};

/// Constrained bi-directional RRT: the search of plan_birrt, but every step is projected onto the
/// constraint, and an extension slides along it towards its target as long as it comes nearer.
/// Waypoints are at most `step` apart, each within RegionConstraint::kWaypointTolerance of the
/// region, and the line between two within kBetweenTolerance. A goal off the constraint is left
/// out; a start or goal off it is not checked for collisions. Reasons besides those of plan_birrt:
/// StartOffConstraint and GoalsOffConstraint.
/// \throws std::invalid_argument as plan_birrt.
/// Source: Berenson, Srinivasa and Kuffner, Task Space Regions (IJRR 2011), section 5.
PlanSummary plan_cbirrt2(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const ConstrainedFreedom& freedom, const ConfigurationSampler& sampler,
                         const BirrtOptions& options, std::mt19937_64& generator);

}  // namespace kinship::planning
