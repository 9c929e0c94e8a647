#pragma once

#include <string>
#include <vector>

#include "server/fitting/source_transfer.hpp"

namespace kinship::fitting {

/// What became of each source's poses, for the reason of a failure.
std::string describe_sources(const std::vector<SourceSummary>& sources);

/// What a reader of the distribution should know: what was left out, sources of which only a part
/// was read, placements that were missing. Mostly empty; at most kMaxMessageBytes.
/// \param target_is_placed  whether the request gave the target's placement.
std::string describe_warnings(const std::vector<SourceSummary>& sources, bool target_is_placed);

}  // namespace kinship::fitting
