#pragma once

#include <string>
#include <vector>

#include "server/fitting/source_transfer.hpp"

namespace kinship::fitting {

/// Outcome of each source's poses, for the reason of a failure.
std::string describe_sources(const std::vector<SourceSummary>& sources);

/// Warnings for a reader of the distribution: paths and sources left out, sources of which only a
/// part was read, missing placements. Mostly empty; at most kMaxMessageBytes.
/// \param target_is_placed  whether the request gave the target's placement.
std::string describe_warnings(const std::vector<SourceSummary>& sources, bool target_is_placed);

}  // namespace kinship::fitting
