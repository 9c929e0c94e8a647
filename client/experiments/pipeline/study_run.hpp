#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "client/experiments/pipeline/query_runner.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {

/// Instances of a quick run: learning ones of each robot at most, and test ones, each planned once.
inline constexpr std::uint32_t kQuickLearning = 20, kQuickInstances = 6;

/// Where and how a study runs.
struct RunOptions {
  std::filesystem::path folder;    ///< of learning sets, results and the store
  std::filesystem::path models;    ///< of the robots' model folders
  std::filesystem::path kinshipd;  ///< empty: beside this program
  std::filesystem::path analysis;  ///< client/experiments/analyse.py
  std::uint32_t domain = 0;
  int threads = 2;
  /// Learning instances of each robot; 0: as the study has it. Otherwise the results have a folder
  /// of their own.
  std::uint32_t learning = 0;
  bool resume = false;  ///< go on with what the folder holds
  bool quick = false;   ///< few instances: shows that everything works, measures nothing
};

/// What is tried on tuning instances; what is missing is as the study has it.
struct TuningOptions {
  std::string profile = "default";
  std::optional<double> overshoot;
  double share = 1;            ///< of guided samples; the rest is uniform
  std::optional<Guide> guide;  ///< missing: what the server found by rehearsal
  std::uint32_t instances = 30;
  std::uint32_t seeds = 2;
  std::vector<std::string> targets, sources;  ///< labels; empty: all. A source may be kOtherRobots
};

/// As a source of a tuning run: all robots but the one that plans, together.
inline constexpr const char* kOtherRobots = "others";

/// Runs the frozen study on its test instances: learning sets, distributions, queries, report.
/// Results go into `<folder>/<study>/`, and on `messages` how far it is.
void run_study(const Study& study, const RunOptions& options, std::ostream& messages);

/// Plans the cells of a side study (side_study.hpp) on the test instances of a study that was run
/// before, and writes the report again.
void run_side_study(const Study& study, const std::string& name, const RunOptions& options,
                    std::ostream& messages);

/// Has tables and figures made of the results that the folder holds, `<folder>/<study>/RESULTS.md`,
/// without planning.
/// \throws Failure(Internal) that says how to have them made if that did not succeed.
void report_study(const Study& study, const RunOptions& options, std::ostream& messages);

/// Has a table made over the kinds of a family that the folder holds, `<folder>/<family>.md`.
/// \throws Failure(Internal) as report_study.
void report_family(const std::string& family, const RunOptions& options, std::ostream& messages);

/// Writes the test instances of one robot as problems for kinship-plan, one a line.
void write_test_problems(const Study& study, const RunOptions& options, const std::string& robot,
                         std::ostream& out);

/// Plans tuning instances, never test instances; what guidance was worth goes to standard output.
/// Learning sets, store and results of earlier tries in the folder are used again.
/// \throws Failure as report_study.
void tune_study(const Study& study, const RunOptions& options, const TuningOptions& tuning,
                std::ostream& messages);

/// Plans calibration instances uniformly; what they cost beside the paper's figures goes to
/// standard output.
/// \throws Failure as report_study.
void calibrate_study(const Study& study, const RunOptions& options, std::uint32_t instances,
                     std::ostream& messages);

}  // namespace kinship::experiments
