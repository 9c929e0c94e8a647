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

/// \param state  of the query's start, up to date.
Goals read_goals(const planning_scene::PlanningScene& scene, const moveit::core::RobotState& state,
                 const MotionPlanRequest& request, const std::string& tip_link);

}  // namespace kinship_moveit
