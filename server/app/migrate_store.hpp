#pragma once

#include <iosfwd>

#include "server/app/migrate_store_options.hpp"

namespace kinship::app {

/// Moves a store. Writes a summary and the next steps to `out`, failures to `err`, and progress to
/// `err` if `show_progress`.
/// \return kDone; kFailed, also while a server has the source open; kWrongUsage; kNotFound.
int run_migrate_store(const MigrateStoreOptions& options, std::ostream& out, std::ostream& err,
                      bool show_progress);

}  // namespace kinship::app
