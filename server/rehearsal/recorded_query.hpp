#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "proto/types/recorded_scene.hpp"
#include "proto/types/uuid.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::rehearsal {

/// The query that a stored path answered, independent of its robot.
struct RecordedQuery {
  Uuid path;                       ///< the report with the answer
  Eigen::Isometry3d T_task_base;   ///< where the robot that answered stood
  Eigen::Isometry3d T_task_start;  ///< of the transfer frame
  Eigen::Isometry3d T_task_goal;
  /// The rehearsed robot's own answer, dof x n; missing: another robot answered.
  std::optional<Eigen::MatrixXd> own;
  std::shared_ptr<const RecordedScene> scene;  ///< null: none was recorded
  /// Where the rehearsed robot stands instead of where it is today; of another robot's.
  std::optional<Eigen::Isometry3d> T_task_drawn_base = {};
};

/// Step parameters of the planner of a task's reports: "step=0.1 overshoot=1" in their options.
struct RecordedSteps {
  double step = 0.05;
  double overshoot = 1.5;
};

struct RecordedQueries {
  std::vector<RecordedQuery> queries;
  RecordedSteps steps;  ///< of the newest report that has them
};

/// Queries of the experience of a distribution: at most `most`, equally many of each robot, spread
/// evenly over the order of arrival. Paths and scenes that cannot be read are left out.
/// \param stop  checked between pages of paths; the result is then incomplete.
/// \throws Failure(Storage)
RecordedQueries read_queries(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
                             const fitting::DistributionKey& key, std::size_t most,
                             const std::stop_token& stop);

}  // namespace kinship::rehearsal
