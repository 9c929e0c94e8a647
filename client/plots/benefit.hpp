#pragma once

#include <vector>

#include "client/plots/task_history.hpp"

namespace kinship::plots {

/// Fills in the estimated worth of guidance at the end of each bin with judged attempts: of the
/// planner of most of them, because checks of two planners cannot be compared; of all profiles
/// together. Nothing before kMinCompared of either mode.
/// \param attempts  of one robot, by time.
void add_benefit(const std::vector<const AttemptSummary*>& attempts, const TaskHistory& history,
                 RobotHistory& robot);

}  // namespace kinship::plots
