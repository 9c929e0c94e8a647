#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/store/values/experience_key.hpp"
#include "server/store/values/prepared_attempt.hpp"

/// The state of a store that a batch of reports depends on. The engine reads it in the transaction
/// that writes the changes, so that nothing changes in between.
namespace kinship::store {

using PreparedAttempts = std::span<const PreparedAttempt* const>;

struct KnownRobot {
  std::int64_t id = 0;
  std::int64_t dof = 0;
};

/// An earlier report under a UUID.
struct EarlierReport {
  Digest body;
  std::string machine;
  std::int64_t received_ms = 0;
  std::optional<std::int64_t> path_id = {};
  /// True if the path can be read, or need not be: there is none, or it is retired.
  bool is_path_backed = true;
  bool is_scene_readable = true;  ///< or there is none
  /// The name of its task in `pairs`, which was renamed since; empty: that of the report.
  std::string task = {};
};

/// Paths with the content of a new one, neither retired nor replaced.
struct SameContent {
  std::optional<std::int64_t> readable;
  std::vector<std::int64_t> damaged;      ///< in use until now: they are counted
  std::vector<std::int64_t> quarantined;  ///< quarantined before: they are not counted any more
};

/// A path in use that may be dropped.
struct KeptPath {
  Digest content;
  std::int64_t id = 0;
  /// Checksum of its row as a dropped path; 0 if the engine reads the row to drop it.
  std::uint32_t crc_when_dropped = 0;

  /// The path to be dropped first is the first.
  bool operator<(const KeptPath& other) const {
    return content != other.content ? other.content < content : other.id < id;
  }
};

/// A robot and task of the batch.
struct Pair {
  ExperienceKey key;
  std::uint64_t paths = 0;                 ///< in use
  std::map<Digest, SameContent> contents;  ///< of the batch's paths
  std::set<KeptPath> largest;              ///< as many as the batch may drop, and one more
};

/// A digest of a robot with the name of a task.
using PairName = std::pair<Digest, std::string>;

struct BatchState {
  std::map<Digest, KnownRobot> robots;  ///< registered ones
  std::map<Uuid, EarlierReport> reports;
  std::set<Uuid> unreadable;  ///< earlier reports that were counted; their rows are damaged
  std::map<Uuid, std::int64_t> retired_paths;  ///< of reports whose rows are damaged or lost
  std::set<Uuid> retired;                      ///< reports whose path is retired, here or elsewhere
  std::map<PairName, Pair> pairs;
  std::map<Digest, bool> scenes;       ///< by content: whether it can be read
  std::vector<std::int64_t> path_ids;  ///< for new paths; one for each attempt with a path
};

}  // namespace kinship::store
