#pragma once

#include <Eigen/Core>
#include <random>

#include "robots/planning/birrt.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/is_free.hpp"

namespace kinship::planning {

/// RRT-Connect over whole lines: a line is an edge of a tree if its configurations, at most a step
/// apart, are free; the first ones asked are spread over all of the line. A dynamic domain: a node
/// from which a line was refused takes no samples that are far away, but one of 64. Every goal is a
/// root of the goal tree. First the straight lines from the start to the goals are tried. An edge
/// is at most kConnectRange long. Samples are the sampler's; its tracks are not followed. Equal
/// seed, equal path, as long as the time limit does not end the search.
/// \param start    dof.
/// \param goals    dof x n; colliding ones are left out.
/// \param options  overshoot and track_check_fraction are not used.
/// \return         its waypoints are the path's vertices: the configurations between two were free.
///                 Of a question for several configurations one check counts if one collides, else
///                 all.
/// \throws std::invalid_argument as plan_birrt.
///
/// Source: J. Kuffner, S. LaValle, RRT-Connect, ICRA 2000; L. Jaillet et al., Adaptive tuning of
/// the sampling domain for dynamic-domain RRTs, IROS 2005; balance and parameters: W. Thomason, Z.
/// Kingston, L. Kavraki, Motions in Microseconds via Vectorized Sampling-Based Planning, ICRA 2024.
PlanSummary plan_rrt_connect(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                             const IsFree& is_free, const ConfigurationSampler& sampler,
                             const BirrtOptions& options, std::mt19937_64& generator);

/// Longest edge of plan_rrt_connect, joint units.
inline constexpr double kConnectRange = 1.0;

}  // namespace kinship::planning
