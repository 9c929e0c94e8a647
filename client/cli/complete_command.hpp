#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

namespace kinship::cli {

/// `candidates`, which completion scripts ask: what the server knows that a word could be, one a
/// line, the newest first; nothing, and no complaint, without an answer.
/// \param kind  ROBOT, TASK, DISTRIBUTION, PATH or JOB (proto/manual/usage.hpp).
int print_candidates(link::Client& server, const std::string& kind, std::ostream& out);

}  // namespace kinship::cli
