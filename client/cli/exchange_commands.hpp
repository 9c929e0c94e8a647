#pragma once

#include <filesystem>
#include <iosfwd>

#include "client/cli/distribution_query.hpp"
#include "client/cli/job_commands.hpp"
#include "client/link/client.hpp"

/// Commands that bring out what a server computes.
namespace kinship::cli {

struct ConfigurationsOptions {
  DistributionQuery query;
  std::filesystem::path output;  ///< empty: standard output
  WaitOptions waiting;
};

/// `configurations export`: exactly the rows of the distribution's fit, as CSV.
int export_configurations(link::Client& server, const ConfigurationsOptions& options,
                          std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
