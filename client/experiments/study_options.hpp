#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "client/experiments/pipeline/study_run.hpp"

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::experiments {

/// What the command line says about running a study.
struct StudyOptions {
  std::string study;  ///< or a family of studies; empty: none is to be run
  RunOptions run;
  std::vector<std::string> sides;  ///< side studies to run, nothing else
  bool reports = false;            ///< only the report is written again
  bool tunes = false;
  TuningOptions tuning;
  std::uint32_t calibration_instances = 0;  ///< 0: no calibration
  std::string problems_of;                  ///< robot whose test instances are written; empty: none
};

/// A subcommand for every study and for every family of studies.
/// \param options  filled in when the command line is parsed; must outlive it.
void add_study_commands(CLI::App& app, StudyOptions& options);

/// Does what the options say. \throws Failure
void run_study_command(const StudyOptions& options, std::ostream& out, std::ostream& messages);

}  // namespace kinship::experiments
