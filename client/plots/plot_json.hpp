#pragma once

#include <string>

#include "client/plots/distribution_plot.hpp"
#include "client/plots/task_history.hpp"

/// What the programs of the pages read. Lengths are whole millimetres, times Unix time in ms.
namespace kinship::plots {

/// The distribution as `distributions fetch --json` has it, without its mixture, beside what was
/// found from it.
std::string to_json(const DistributionPlot& plot);

std::string to_json(const TaskHistory& history);

}  // namespace kinship::plots
