#pragma once

#include <iosfwd>

#include "server/app/options.hpp"

namespace kinship::app {

/// Runs the server until SIGTERM, SIGINT or SIGHUP, then drains it. Writes one line to `out` when
/// it serves; the log goes to stderr. \return kDone. \throws Failure if the store cannot be opened
/// or the domain cannot be joined.
int serve(const ServerOptions& options, std::ostream& out);

}  // namespace kinship::app
