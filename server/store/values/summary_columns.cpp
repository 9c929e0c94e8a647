#include "server/store/values/summary_columns.hpp"

#include <utility>

namespace kinship::store {

TaskSummary summary_of(std::string_view task, std::vector<TaskRobotSummary> robots) {
  TaskSummary summary;
  summary.task = task;
  summary.robots = std::move(robots);
  std::ranges::sort(summary.robots, {}, &TaskRobotSummary::label);
  for (const TaskRobotSummary& robot : summary.robots) {
    summary.paths += robot.paths;
    summary.attempts += robot.attempts;
    summary.dropped += robot.dropped;
  }
  return summary;
}

}  // namespace kinship::store
