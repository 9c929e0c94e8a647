#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/cli/distribution_query.hpp"
#include "client/cli/job_commands.hpp"
#include "client/link/client.hpp"

/// Commands that export a server's data to a file.
namespace kinship::cli {

struct ExportOptions {
  std::string robot, task;       ///< filters; empty: all
  std::filesystem::path output;  ///< empty: standard output
  bool progress = false;         ///< on `err`, unless the rows go to a terminal themselves
};

/// `paths export`: attempts as JSON Lines, preceded by their robots.
int export_paths(link::Client& server, const ExportOptions& options, std::ostream& out,
                 std::ostream& err);

struct ConfigurationsOptions {
  DistributionQuery query;
  std::filesystem::path output;  ///< empty: standard output
  WaitOptions waiting;
};

/// `configurations export`: exactly the rows of the distribution's fit, as CSV.
int export_configurations(link::Client& server, const ConfigurationsOptions& options,
                          std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
