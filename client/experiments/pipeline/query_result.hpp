#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/result.hpp"

namespace kinship::experiments {

/// Which query of a study: unique within a log.
struct QueryKey {
  std::string robot;     ///< that planned
  std::string guidance;  ///< name of the cell: "uniform", a source's label, ...
  std::string instance;
  std::uint32_t seed = 0;  ///< 0, 1, ...: added to the instance's own

  auto operator<=>(const QueryKey&) const = default;
};

/// What one query of a study cost.
struct QueryResult {
  QueryKey key;
  std::optional<Digest> distribution;  ///< that its samples came from
  bool solved = false;
  std::uint64_t checks = 0;  ///< of planning, to the first path or the limit
  std::uint64_t goal_checks = 0;
  std::uint64_t projections = 0;
  double cpu_s = 0;  ///< of the planning thread: sampling, projection, checks; no goal IK, no fetch
  double length = 0;  ///< of the path, joint units; 0 if unsolved
  /// Whether a guided query was planned uniformly because its start or goals are far from all that
  /// the distribution knows. Missing in rows that are older than it, and of peers.
  std::optional<bool> gate_fired = std::nullopt;
  /// Of samples: how many were guided, as planned. Missing likewise.
  std::optional<double> guided_share = std::nullopt;
  /// Of samples: how many were drawn around tracks. Missing in rows that are older than it.
  std::optional<double> track_share = std::nullopt;
  std::optional<FoundBy> found_by = std::nullopt;  ///< missing likewise
  std::optional<Guide> guide = std::nullopt;       ///< of a guided one; missing likewise
};

/// One line of JSON.
std::string to_json(const QueryResult& result);

/// \return the result, or InvalidInput that names what is wrong.
Result<QueryResult> query_result_from_json(std::string_view text);

}  // namespace kinship::experiments
