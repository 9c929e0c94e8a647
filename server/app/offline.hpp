#pragma once

#include <iosfwd>

#include "server/app/options.hpp"

namespace kinship::app {

/// Runs one verb on a store that no server has open. Writes a summary to `out`, failures to `err`,
/// and progress to `err` if `show_progress`.
/// \return kDone; kFailed, also if a check found damage or a server has the store open;
///         kWrongUsage; kNotFound.
int run_offline(const OfflineOptions& options, std::ostream& out, std::ostream& err,
                bool show_progress);

}  // namespace kinship::app
