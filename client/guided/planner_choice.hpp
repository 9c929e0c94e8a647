#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <string>
#include <string_view>

#include "proto/types/result.hpp"
#include "robots/planning/birrt.hpp"

namespace kinship::guided {

enum class PlannerKind {
  ByProblem,  ///< BiRRT, or CBiRRT2 under a constraint
  Birrt,
  Cbirrt2,
  Roadmap,
  RrtConnect,  ///< whole lines at once; not under a constraint
  Other        ///< of another library
};

/// A planner of another library; it promises what planning::plan_trees does.
using OtherPlanner = std::function<planning::PlanSummary(
    const Eigen::VectorXd& start, const Eigen::MatrixXd& goals, const planning::Freedom& freedom,
    const planning::ConfigurationSampler& sampler, const planning::BirrtOptions& options,
    std::mt19937_64& generator)>;

/// The planner of a run's problems.
struct PlannerChoice {
  PlannerKind kind = PlannerKind::ByProblem;
  std::string other_name = {};  ///< as name_of says it; with Other only
  OtherPlanner other = {};      ///< never empty with Other
};

/// "birrt", "cbirrt2", "roadmap" or "rrtconnect"; ompl_planners::parse_planner also knows OMPL's.
/// \return InvalidInput that shows the text and the valid names.
Result<PlannerChoice> parse_planner(std::string_view text);

/// The planner of one problem; never ByProblem. CBiRRT2 without a constraint is BiRRT.
/// \return InvalidInput that names the planners able to plan the problem, if this one is not.
Result<PlannerChoice> planner_for(const PlannerChoice& wanted, bool is_constrained);

/// Its name in results and reports: "BiRRT", "CBiRRT2", "Repetition Roadmap",
/// "RRT-Connect", "OMPL RRTConnect".
std::string name_of(const PlannerChoice& planner);

}  // namespace kinship::guided
