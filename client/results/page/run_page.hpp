#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robots/models/robot_arguments.hpp"

namespace kinship::results {

/// The files of an experienced robot: its problems and the results of kinship-plan.
struct TeacherFiles {
  std::filesystem::path model, problems, results;
};

/// A robot that planned the same problems with uniform and with guided sampling, as page.py found
/// it.
struct PageRun {
  models::RobotArguments robot;
  std::filesystem::path problems;
  std::filesystem::path uniform, guided;  ///< results of kinship-plan
  std::filesystem::path distribution;     ///< kinship distributions fetch --json, of before
  std::filesystem::path advice;           ///< the same of after; empty: the page has no advice
  /// kinship-plan --searches; empty: the page does not show how searches grew.
  std::filesystem::path uniform_searches, guided_searches;
  std::vector<TeacherFiles> teachers;
  std::string shown;  ///< name of the problem that the page shows
  /// Members of the page's data that are statistics (kinship_results/page_figures.py). "typical" is
  /// null where no instance was solved by both: the page shows a problem without paths.
  nlohmann::ordered_json figures;
};

/// \param document  of page.py. \param robot  of the command line, without a source.
PageRun parse_run(const std::string& document, models::RobotArguments robot);

/// Writes one HTML document that needs nothing else: style, programs (three.js, vega) and data are
/// in it, and it forbids the browser to load anything. Samples are seeded: equal files, equal page.
/// \throws Failure that names the file if one is missing or broken, or does not belong to the
/// others.
void write_page(const PageRun& run, std::ostream& out);

}  // namespace kinship::results
