#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/cli/distribution_query.hpp"
#include "client/link/client.hpp"

/// Pages of what a server knows (client/plots). Each is written to a file that has its name once it
/// is whole, or to `out` if the file is "-".
namespace kinship::cli {

struct PlotOptions {
  std::filesystem::path output;
  bool progress = false;  ///< shown on `err`
};

/// `distributions plot`: a distribution over its robot, its components, marginals and sources.
/// \return kNotFound for one that is not there, has no experience, or no mixture.
int plot_distribution(link::Client& server, const DistributionQuery& query,
                      const PlotOptions& options, std::ostream& out, std::ostream& err);

/// `tasks plot`: what was reported of a task over time, and what guidance was worth.
/// \return kNotFound for a task that is not there or of which nothing was reported.
int plot_task(link::Client& server, const std::string& task, const PlotOptions& options,
              std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
