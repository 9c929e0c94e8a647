#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "client/experiments/page/run_files.hpp"

namespace CLI {  // NOLINT: theirs
class App;
}  // namespace CLI

namespace kinship::experiments {

/// The command line of `page`.
struct PageOptions {
  RunLocation run;
  std::vector<std::string> teachers;  ///< "MODEL,PROBLEMS,RESULTS" each
  std::vector<std::string> also;      ///< "NAME=FILE" each
  std::filesystem::path output;       ///< empty: standard output
};

/// Adds the command `page`. \param options  filled when the command line is parsed; must outlive
/// that.
void add_page_command(CLI::App& app, PageOptions& options);

/// Writes the page.
/// \throws Failure that says what the run lacks, or which file is broken.
void run_page_command(PageOptions options);

}  // namespace kinship::experiments
