#pragma once

#include <iosfwd>

#include "server/app/check_sites_options.hpp"

namespace kinship::app {

/// Names the reports that a site and the memory above it do not have alike. Changes neither.
/// \return kDone: no UUID has two contents, none is damaged; kFailed; kWrongUsage; kNotFound.
int run_check_sites(const CheckSitesOptions& options, std::ostream& out, std::ostream& err);

}  // namespace kinship::app
