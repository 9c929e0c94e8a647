#pragma once

#include <string>
#include <vector>

#include "proto/types/profile.hpp"
#include "server/fitting/source_transfer.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::fitting {

/// What the configurations of a fit were filtered with, how many that left out, and what was not
/// filtered and why; at most kMaxMessageBytes.
std::string describe_filters(const TransferParameters& wanted, const runtime::Robot& target,
                             const std::vector<SourceSummary>& sources);

}  // namespace kinship::fitting
