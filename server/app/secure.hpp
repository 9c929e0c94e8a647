#pragma once

#include <chrono>
#include <iosfwd>

#include "server/app/secure_options.hpp"

namespace kinship::app {

/// Runs one verb on a security folder. Writes a summary and the next steps to `out`, failures and
/// warnings to `err`.
/// \return kDone, kFailed, kWrongUsage or kNotFound.
int run_secure(const SecureOptions& options, std::chrono::sys_seconds now, std::ostream& out,
               std::ostream& err);

}  // namespace kinship::app
