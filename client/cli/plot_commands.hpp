#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/cli/distribution_query.hpp"
#include "client/link/client.hpp"
#include "proto/files/output_file.hpp"

namespace kinship::cli {

struct PlotOptions {
  std::filesystem::path output;
  bool progress = false;  ///< shown on `err`
};

/// `distributions plot`: a distribution over its robot, the poses that its transfer lost, its
/// components, marginals and sources.
/// \return kNotFound for an unknown one, or one without experience or mixture.
int plot_distribution(link::Client& server, const DistributionQuery& query,
                      const PlotOptions& options, std::ostream& out, std::ostream& err);

/// `tasks plot`: the newest paths of a task in space, its reports over time, and the benefit of
/// guidance.
/// \return kNotFound for an unknown task, or one without reports.
int plot_task(link::Client& server, const std::string& task, const PlotOptions& options,
              std::ostream& out, std::ostream& err);

/// `robots plot`: the solids of a robot's links, its joints to move, its transfer frame.
/// \param name  a label, or the beginning of a digest.
int plot_robot(link::Client& server, const std::string& name, const PlotOptions& options,
               std::ostream& out, std::ostream& err);

/// `paths plot`: a path in its recorded scene, and how near it comes to what.
/// \param id  a report UUID.
/// \return kNotFound for an unknown one, or one without a path.
int plot_path(link::Client& server, const std::string& id, const PlotOptions& options,
              std::ostream& out, std::ostream& err);

/// `attempts plot`: the same of any attempt; of a failed one what was in the way, as far as it was
/// recorded.
int plot_attempt(link::Client& server, const std::string& id, const PlotOptions& options,
                 std::ostream& out, std::ostream& err);

/// The output of a page: a file that gets its name once it is complete, or a stream for "-".
class PageFile {
 public:
  /// \throws Failure(Storage) as OutputFile.
  PageFile(const std::filesystem::path& file, std::ostream& otherwise);

  std::ostream& stream() noexcept { return output_.stream(); }

  /// Completes the page and writes its place to `err`. \throws Failure(Storage) as OutputFile.
  void keep(std::ostream& err);

 private:
  std::filesystem::path file_;  // empty: the stream
  files::OutputFile output_;
};

}  // namespace kinship::cli
