#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kinship::experiments {

/// A run of client/experiments/analyse.py, which makes the tables and figures of a study.
struct AnalysisRun {
  std::filesystem::path script;
  std::filesystem::path folder;  ///< of the study
  std::string option;            ///< "--calibration", "--tuning"; empty: the whole report

  /// What to type to have it run again.
  std::string command() const;
};

/// Runs it with Debian's Python; its output and messages go where those of this program go.
/// \return whether it did what it should. If not, it has said why.
bool run_analysis(const AnalysisRun& run);

}  // namespace kinship::experiments
