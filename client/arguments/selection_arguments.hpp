#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/selection.hpp"

namespace kinship::arguments {

/// What --sources, --weighting and --since said: which part of a task's experience is wanted.
struct SelectionArguments {
  std::string sources;    ///< labels or beginnings of digests, separated by commas; empty: all
  std::string weighting;  ///< a word of enum_text; empty: the profile's
  std::string since;      ///< see parse_since(); empty: all
};

/// The names of an option that takes several, separated by commas: without empty ones, each once.
/// \return InvalidInput that names what cannot be the label or digest of a robot, or more than
///         kMaxSelectedSources of them.
Result<std::vector<std::string>> parse_robot_names(std::string_view text);

/// A moment: a date or time in UTC ("2026-11-21", "2026-11-21T05:32", "2026-11-21T05:32:14Z"), an
/// age before `now`: a number and s, m, h, d or w ("90m", "14d"), or Unix time in ms as `--json`
/// prints it: ten digits or more ("1795239134000"). An age goes back to the beginning of its
/// minute, from two hours on of its hour, from two days on of its day in UTC: each moment is a
/// distribution of its own, and who asks again soon means the same one. \return Unix time in ms, at
/// least 0; or InvalidInput that shows the text.
Result<std::int64_t> parse_since(std::string_view text, std::chrono::system_clock::time_point now);

/// The selection but for its sources: their digests are known to the server only
/// (link::resolve_robots).
Result<Selection> read_selection(const SelectionArguments& arguments,
                                 std::chrono::system_clock::time_point now);

}  // namespace kinship::arguments
