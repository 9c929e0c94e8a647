#pragma once

#include <Eigen/Core>
#include <random>
#include <string>
#include <vector>

#include "robots/planning/birrt.hpp"

namespace kinship::ompl_planners {

struct OmplOptions {
  std::string planner = "RRTConnect";  ///< one of ompl_planner_names()
  /// Longest extension, joint units; 0: OMPL's choice, a fifth of the space's extent. Planners
  /// without extensions have none.
  double range = 0;
  planning::BirrtOptions limits;  ///< step, checks and time; OMPL knows no overshoot
};

/// The planners that draw uniform samples from the space, so that guidance reaches them, in
/// alphabetical order: RRT, RRTConnect and LazyRRT among others, without planners that only sample
/// near their states (EST, KPIECE, SBL and the like).
std::vector<std::string> ompl_planner_names();

/// Plans one query with a planner of OMPL, its uniform samples replaced by those of the sampler.
/// The query ends at the first path, also for planners that would go on to shorten it.
///
/// Same definitions as plan_birrt: every checked configuration counts one check, none beyond the
/// budget; waypoints are at most limits.step apart and each was checked, and motions are proven if
/// `is_free` proves edges. Start and goals are checked first, and again by OMPL. Samples are seeded
/// from the generator, but OMPL's own draws (for example towards the goal) follow its process-wide
/// seed: equal plans need an equal seed there. PRM and PRMstar grow by samples only, without OMPL's
/// random walks and second thread; RRTConnect and LazyPRM know all goals from the beginning.
/// Silences OMPL's messages for the process.
///
/// Reasons as plan_birrt; if OMPL gave up before checks and time were used up, GaveUp with its
/// status as the planner's message.
/// \throws std::invalid_argument as plan_birrt, if bounds leave a joint no room, the range is
///         negative, or for an unknown planner, with the known names.
/// \throws Failure(Internal) with the message of OMPL's exception.
planning::PlanSummary plan_with_ompl(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                                     const planning::IsFree& is_free,
                                     const planning::ConfigurationSampler& sampler,
                                     const OmplOptions& options, std::mt19937_64& generator);

/// The same along a task space region, on a RegionStateSpace; paths, goals and reasons as in
/// plan_cbirrt2. The dof is at least 2.
planning::PlanSummary plan_with_ompl(const Eigen::VectorXd& start, const Eigen::MatrixXd& goals,
                                     const planning::ConstrainedFreedom& freedom,
                                     const planning::ConfigurationSampler& sampler,
                                     const OmplOptions& options, std::mt19937_64& generator);

}  // namespace kinship::ompl_planners
