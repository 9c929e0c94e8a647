#pragma once

#include <vector>

#include "client/plots/task_history.hpp"

namespace kinship::plots {

/// Fills in what is believed of the worth of guidance at the end of each bin in which judged
/// attempts came: that of the planner that most of them are of, because checks of two cannot be
/// compared; of all profiles together. Nothing before kMinCompared of either mode.
/// \param attempts  of one robot, by time.
void add_benefit(const std::vector<const AttemptSummary*>& attempts, const TaskHistory& history,
                 RobotHistory& robot);

}  // namespace kinship::plots
