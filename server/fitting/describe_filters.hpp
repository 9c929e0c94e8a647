#pragma once

#include <string>
#include <vector>

#include "proto/types/profile.hpp"
#include "server/fitting/source_transfer.hpp"
#include "server/runtime/robot_registry.hpp"

namespace kinship::fitting {

/// The filters applied to the configurations of a fit, the number left out, and the filters not
/// applied and why; at most kMaxMessageBytes.
std::string describe_filters(const TransferParameters& wanted, const runtime::Robot& target,
                             const std::vector<SourceSummary>& sources);

}  // namespace kinship::fitting
