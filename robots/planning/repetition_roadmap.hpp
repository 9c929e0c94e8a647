#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "robots/planning/birrt.hpp"
#include "robots/planning/configuration_sampler.hpp"

namespace kinship::planning {

struct RoadmapOptions {
  /// Step, checks and time of the whole query; the overshoot is that of the trees.
  BirrtOptions tree;
  int draws = 3;        ///< vertices of a component besides its mean
  int neighbours = 5;   ///< fewest components that each component is linked to
  int connections = 8;  ///< vertices that start and each goal are linked to
  /// Checks of the roadmap, out of tree.max_checks, before the trees take over.
  std::uint64_t max_roadmap_checks = 2000;
};

/// A roadmap over more components would cost more than the search it saves (it compares all pairs);
/// kernels are also too narrow to be places of their own.
inline constexpr Eigen::Index kMaxRoadmapComponents = 1024;

/// Repetition Roadmap: a roadmap over the components of the sampler's mixture, searched lazily.
///
/// Vertices are the mean of each component and draws of it, within the bounds, moved to the turn
/// nearest to the start as samples are; those that do not fit are left out. Two components are
/// linked if their Bhattacharyya distance is at most 1, or if one is among the `neighbours` nearest
/// of the other; all vertices of a component and of those linked to it are joined by edges. Start
/// and goals are linked to the vertices nearest to them and with each other. An edge costs its
/// length times 1 + the doubt about it: the squared Mahalanobis distance per joint of its middle
/// from the nearer of its two components. The cheapest path is searched (A*) as if all were free;
/// then its vertices are checked, and its edges, the most doubtful first and from the middle
/// outwards. Blocked vertices and edges are removed, until a path is free, no path is left or
/// max_roadmap_checks are used up. Then the search of plan_birrt takes over with the remaining
/// budget, starting from the configurations that the roadmap found reachable.
///
/// Arguments, guarantees, counts and reasons as plan_birrt. `iterations` are those of the trees: 0
/// if the roadmap had the path. Without a mixture, or with more than kMaxRoadmapComponents
/// components, the trees plan alone, guided all the same.
/// \throws std::invalid_argument as plan_birrt, or if draws, neighbours or connections are
///         negative.
/// \throws Failure(Internal) if a covariance is not positive definite.
/// Source: the idea of Lehner and Albu-Schaeffer, The Repetition Roadmap for Repetitive Constrained
/// Motion Planning (RA-L 2018); closeness, costs and order of checks are our own choice.
PlanSummary plan_roadmap(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const IsFree& is_free, const ConfigurationSampler& sampler,
                         const RoadmapOptions& options, std::mt19937_64& generator);

/// The same along a task space region: vertices are projected onto it, edges follow it in the steps
/// of plan_cbirrt2, whose trees take over. Paths, goals and reasons as in plan_cbirrt2.
PlanSummary plan_roadmap(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                         const ConstrainedFreedom& freedom, const ConfigurationSampler& sampler,
                         const RoadmapOptions& options, std::mt19937_64& generator);

}  // namespace kinship::planning
