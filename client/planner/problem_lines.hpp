#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "proto/types/problem.hpp"
#include "proto/types/result.hpp"

namespace kinship::planner {

/// A line of a problem file that is not blank.
struct ProblemLine {
  std::size_t number = 0;   ///< counts from 1
  Result<Problem> problem;  ///< or the line's error
};

/// Reads every line; an invalid line becomes an error of its own and does not end the reading.
/// \throws Failure(Storage) if the stream itself cannot be read.
std::vector<ProblemLine> read_problem_lines(std::istream& stream);

/// The result for a line that holds no problem.
ProblemResult broken_line_result(std::size_t number, const Error& error);

/// The warning of a run without a transfer frame: poses of its problems are taken for those of the
/// tip link; it names the option to pass. A line, or empty if no problem gives a pose.
std::string transfer_warning(const std::vector<ProblemLine>& lines, const std::string& tip_link);

}  // namespace kinship::planner
