#pragma once

#include <filesystem>
#include <iosfwd>

#include "client/cli/distribution_query.hpp"
#include "client/cli/job_commands.hpp"
#include "client/link/client.hpp"

/// Commands that move experience between a server and files.
namespace kinship::cli {

struct ConfigurationsOptions {
  DistributionQuery query;
  std::filesystem::path output;  ///< empty: standard output
  WaitOptions waiting;
};

/// `configurations export`: exactly the rows of the distribution's fit, as CSV.
int export_configurations(link::Client& server, const ConfigurationsOptions& options,
                          std::ostream& out, std::ostream& err);

struct ImportOptions {
  std::filesystem::path file;  ///< "-": `standard_input`
  bool json = false;           ///< the counts as one document
  bool progress = false;       ///< names the last delivered line on `err`
};

/// `paths import`: sends the lines of an experience file to the server; registers the robots that
/// it describes. May be repeated: the server recognizes stored reports by their UUID.
/// \return kFailed if a line was refused (each is named on `err`); kNoServer if no server answered.
/// \throws Failure if the file cannot be read.
int import_paths(link::Client& server, const ImportOptions& options, std::istream& standard_input,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
