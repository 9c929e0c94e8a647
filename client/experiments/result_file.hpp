#pragma once

#include <filesystem>
#include <vector>

#include "proto/types/problem.hpp"

namespace kinship::experiments {

/// The lines of a result file of kinship-plan.
/// \throws Failure(NotFound) if it cannot be read, Failure(InvalidInput) with the line's number
///         if a line is not a result.
std::vector<ProblemResult> read_results(const std::filesystem::path& file);

}  // namespace kinship::experiments
