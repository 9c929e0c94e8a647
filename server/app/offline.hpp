#pragma once

#include <iosfwd>

#include "server/app/options.hpp"

namespace kinship::app {

/// Does one verb to a store that no server has open. What was done goes to `out`, failures go to
/// `err`, also how far it is if `show_progress`.
/// \return kDone; kFailed, also if a check found damage or a server has the store open;
///         kWrongUsage; kNotFound.
int run_offline(const OfflineOptions& options, std::ostream& out, std::ostream& err,
                bool show_progress);

}  // namespace kinship::app
