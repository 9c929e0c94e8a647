#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "client/results/python_program.hpp"

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::experiments {

/// What the command line says about a study. A study is run in Python (pipeline/), which is told
/// the other options as they were given.
struct StudyOptions {
  std::string study;                  ///< or a family of studies; empty: none is meant
  const CLI::App* command = nullptr;  ///< of it, parsed
  std::filesystem::path models = "robots/models";
  std::string profile = "default";  ///< of --tuning
  bool describes = false;           ///< what the study is made of, as JSON
  std::string problems_of;          ///< robot whose instances are written; empty: none
  std::string peer;                 ///< what answers for that robot instead; empty: none
  std::string set = "test";         ///< of instances
  std::uint32_t instances = 0;      ///< as many; 0: as the study has
  bool is_quick = false;
};

/// A subcommand for every study and for every family of studies.
/// \param options  filled in when the command line is parsed; must outlive it.
void add_study_commands(CLI::App& app, StudyOptions& options);

/// Does what the options say; does not return from a study that is run. \throws Failure
void run_study_command(const StudyOptions& options, std::istream& in, std::ostream& out);

/// Runs pipeline/ in place of this program. \param words  what run_study.py is told.
[[noreturn]] void run_study_program(results::Words words);

}  // namespace kinship::experiments
