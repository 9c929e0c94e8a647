#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace kinship::experiments {

/// One run of a study on its test instances: a report lists all of them.
struct RunRecord {
  std::int64_t begun_s = 0;  ///< Unix time, UTC
  std::string commit;        ///< of the working directory; "+" behind it: with changes
  std::string machine;       ///< processor and number of cores
  std::string study;
  std::string side;           ///< study on the test instances; empty: the test set itself
  std::uint64_t planned = 0;  ///< queries that the log did not have yet
  double duration_s = 0;
};

/// What is known when a run begins.
RunRecord begin_run(const std::string& study, const std::string& side);

/// Adds a line to the file. \throws Failure(Storage) that names it.
void append_run(const std::filesystem::path& file, const RunRecord& record);

}  // namespace kinship::experiments
