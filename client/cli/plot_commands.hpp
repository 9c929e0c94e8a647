#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/cli/distribution_query.hpp"
#include "client/link/client.hpp"

/// Pages of a server's data (client/plots). Each is written to a file that gets its name once it is
/// complete, or to `out` if the file is "-".
namespace kinship::cli {

struct PlotOptions {
  std::filesystem::path output;
  bool progress = false;  ///< shown on `err`
};

/// `distributions plot`: a distribution over its robot, its components, marginals and sources.
/// \return kNotFound for an unknown one, or one without experience or mixture.
int plot_distribution(link::Client& server, const DistributionQuery& query,
                      const PlotOptions& options, std::ostream& out, std::ostream& err);

/// `tasks plot`: the reports of a task over time, and the benefit of guidance.
/// \return kNotFound for an unknown task, or one without reports.
int plot_task(link::Client& server, const std::string& task, const PlotOptions& options,
              std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
