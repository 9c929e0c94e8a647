#pragma once

#include <string>
#include <string_view>

#include "proto/types/problem.hpp"
#include "proto/types/recorded_search.hpp"
#include "proto/types/result.hpp"

/// The lines that kinship-plan reads and writes.
namespace kinship::json {

std::string to_json(const Problem& problem);

/// \return the problem, or InvalidInput or TooLarge that names field, value and limit. Meshes are
///         refused: not supported yet.
Result<Problem> problem_from_json(std::string_view text);

std::string to_json(const ProblemResult& result);
Result<ProblemResult> problem_result_from_json(std::string_view text);

std::string to_json(const RecordedSearch& search);

/// Refused unless every parent precedes its child and the path's nodes exist.
Result<RecordedSearch> recorded_search_from_json(std::string_view text);

}  // namespace kinship::json
