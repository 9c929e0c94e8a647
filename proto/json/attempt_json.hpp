#pragma once

#include <string>
#include <string_view>

#include "proto/types/attempt.hpp"
#include "proto/types/result.hpp"

/// A line of an experience file: `paths export` and `import`, and a client's outbox.
namespace kinship::json {

/// An attempt in a file, where the robot may be named by label.
struct NamedAttempt {
  Attempt attempt;    ///< `robot` is all zeros if a label was given: the reader looks it up
  std::string label;  ///< empty if the digest was given
};

std::string to_json(const Attempt& attempt);  ///< robot as digest

/// \return the attempt, or InvalidInput or TooLarge that names field, value and limit.
///         64 hexadecimal digits are a digest, anything else is a label.
Result<NamedAttempt> attempt_from_json(std::string_view text);

/// The same for an attempt of a store, whose path may have been dropped: solved, without waypoints.
Result<NamedAttempt> stored_attempt_from_json(std::string_view text);

std::string to_json(const SearchRecord& search);  ///< member `search` of an attempt
/// \return the record, which keeps its rules, or an error as attempt_from_json().
Result<SearchRecord> search_record_from_json(std::string_view text);

}  // namespace kinship::json
