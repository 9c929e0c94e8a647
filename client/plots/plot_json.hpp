#pragma once

#include <string>

#include "client/plots/distribution_plot.hpp"
#include "client/plots/task_history.hpp"

/// The data of the pages' scripts. Lengths are whole millimetres, times Unix time in ms.
namespace kinship::plots {

/// The distribution as in `distributions fetch --json`, without its mixture, and the data derived
/// from it.
std::string to_json(const DistributionPlot& plot);

std::string to_json(const TaskHistory& history);

}  // namespace kinship::plots
