#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "robots/models/robot_arguments.hpp"

namespace CLI {  // NOLINT: theirs
class App;
}  // namespace CLI

namespace kinship::experiments {

/// The command line of `page`. Python finds the run's files and figures (page.py), which is told
/// the other options as they were given, and calls the command again to draw them.
struct PageOptions {
  const CLI::App* command = nullptr;  ///< of it, parsed
  models::RobotArguments robot;
  std::filesystem::path output;  ///< empty: standard output
  bool draws = false;            ///< the run that standard input describes
};

/// Adds the command `page`. \param options  filled when the command line is parsed; must outlive
/// that.
void add_page_command(CLI::App& app, PageOptions& options);

/// Writes the page of the run on standard input, or does not return.
/// \param arguments  of this program.
/// \throws Failure that names a file that is broken.
void run_page_command(const PageOptions& options, const std::vector<std::string>& arguments);

}  // namespace kinship::experiments
