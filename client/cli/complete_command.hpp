#pragma once

#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

namespace kinship::cli {

/// `candidates`, for completion scripts: the server's names that can complete a word, one per line,
/// the newest first; without an answer no output and no message.
/// \param kind  ROBOT, TASK, DISTRIBUTION, PATH or JOB (proto/manual/usage.hpp).
int print_candidates(link::Client& server, const std::string& kind, std::ostream& out);

}  // namespace kinship::cli
