#pragma once

#include <optional>
#include <string>
#include <vector>

#include "handles.hpp"
#include "moveit_versions.hpp"

namespace kinship_moveit {

/// The goals of a request as libkinship takes them: configurations, or else one pose.
struct Goals {
  std::vector<double> configurations;            ///< dof numbers each, one after the other
  std::optional<Eigen::Isometry3d> T_world_tip;  ///< middle of the first pose goal's regions
  std::string untold;                            ///< a goal that is neither; empty if all are told

  bool has_any() const { return !configurations.empty() || T_world_tip.has_value(); }
};

/// The path constraints of a request as libkinship takes them.
struct KeptRegion {
  std::optional<kinship_region> region;  ///< none: nothing is to be kept
  std::string untold;                    ///< a constraint that it cannot say; empty if all is told
};

/// An orientation of a link that moves with the tip. A little of its tolerances is left to what the
/// planner may be beside its region.
/// \param T_tip_transfer  Settings::T_tip_transfer.
KeptRegion read_path_constraints(const planning_scene::PlanningScene& scene,
                                 const moveit::core::RobotState& state,
                                 const moveit_msgs::msg::Constraints& kept,
                                 const std::string& tip_link, const Eigen::Isometry3d& T_task_world,
                                 const Eigen::Isometry3d& T_tip_transfer);

/// \param state  of the query's start, up to date.
Goals read_goals(const planning_scene::PlanningScene& scene, const moveit::core::RobotState& state,
                 const MotionPlanRequest& request, const std::string& tip_link);

}  // namespace kinship_moveit
