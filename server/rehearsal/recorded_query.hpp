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
#include "server/store/store.hpp"

namespace kinship::rehearsal {

/// What a stored path once answered, said without its robot.
struct RecordedQuery {
  Uuid path;                       ///< the report that brought the answer
  Eigen::Isometry3d T_task_start;  ///< of the transfer frame
  Eigen::Isometry3d T_task_goal;
  /// Of the robot that is rehearsed, if the path is its own and it stood at its placement of today.
  std::optional<Eigen::VectorXd> start;
  std::shared_ptr<const RecordedScene> scene;  ///< null: none was recorded
};

/// How the planner of a task's reports went along: "step=0.1 overshoot=1" in their options.
struct RecordedSteps {
  double step = 0.05;
  double overshoot = 1.5;
};

struct RecordedQueries {
  std::vector<RecordedQuery> queries;
  RecordedSteps steps;  ///< of the newest report that says them
};

/// Queries of the experience that a distribution is made of: at most `most`, as many of each robot,
/// spread evenly over the order of arrival. Paths and scenes that cannot be read are left out.
/// \param stop  looked at between pages of paths: what is returned is incomplete then.
/// \throws Failure(Storage)
RecordedQueries read_queries(const store::Store& store, runtime::RobotRegistry& robots,
                             const fitting::DistributionKey& key, std::size_t most,
                             const std::stop_token& stop);

}  // namespace kinship::rehearsal
