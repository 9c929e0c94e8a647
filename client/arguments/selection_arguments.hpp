#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"
#include "proto/types/selection.hpp"

namespace kinship::arguments {

/// The values of --sources, --weighting and --since, which select a part of a task's experience.
struct SelectionArguments {
  std::string sources;    ///< labels or beginnings of digests, separated by commas; empty: all
  std::string weighting;  ///< a word of enum_text; empty: the profile's
  std::string since;      ///< see parse_since(); empty: all
};

/// The names of an option that takes several, separated by commas: without empty ones, each once.
/// \return InvalidInput that names a word that cannot be the label or digest of a robot, or for
///         more than kMaxSelectedSources of them.
Result<std::vector<std::string>> parse_robot_names(std::string_view text);

/// A moment: a date or time in UTC ("2026-11-21", "2026-11-21T05:32", "2026-11-21T05:32:14Z"), an
/// age before `now`: a number and s, m, h, d or w ("90m", "14d"), or Unix time in ms as `--json`
/// prints it: ten digits or more ("1795239134000"). An age goes back to the beginning of its
/// minute, from two hours on of its hour, from two days on of its day in UTC: each moment makes a
/// distribution of its own, and so a repeated request soon after selects the same one.
/// \return Unix time in ms, at least 0; or InvalidInput that shows the text.
Result<std::int64_t> parse_since(std::string_view text, std::chrono::system_clock::time_point now);

/// The selection without its sources: only the server knows their digests (link::resolve_robots).
Result<Selection> read_selection(const SelectionArguments& arguments,
                                 std::chrono::system_clock::time_point now);

}  // namespace kinship::arguments
