#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/values/prepared_attempt.hpp"

/// What the database knows about the attempts of a batch, read under the locks that keep others
/// from changing it until the batch is committed.
namespace kinship::store::postgres {

/// Of a pair, with one report: each is written anew.
inline constexpr std::uint64_t kMostDroppedAtOnce = 64;

struct KnownRobot {
  std::int64_t id = 0;
  std::int64_t dof = 0;
};

/// A report that came before under a UUID.
struct EarlierReport {
  Digest body;
  std::string machine;
  std::int64_t received_ms = 0;
  std::optional<std::int64_t> path_id = {};
  bool is_path_vouched_for =
      true;  ///< it can be read, or nobody wants it: there is none, or it is retired
  bool is_scene_readable = true;  ///< or there is none
};

/// A path in use with the content of one that comes.
struct SamePath {
  std::int64_t id = 0;
  bool is_readable = true;
};

/// A path in use that may have to go.
struct KeptPath {
  Digest content;
  std::int64_t id = 0;
  std::uint32_t crc_when_dropped = 0;

  /// The one to go first is the first.
  bool operator<(const KeptPath& other) const {
    return content != other.content ? other.content < content : other.id < id;
  }
};

/// The internal ids of a robot and a task.
struct ExperienceKey {
  std::int64_t task_id = 0;
  std::int64_t robot_id = 0;

  auto operator<=>(const ExperienceKey&) const = default;
};

/// A robot and task whose row in `experience` is locked.
struct Pair {
  ExperienceKey key;
  std::uint64_t paths = 0;
  std::map<Digest, SamePath> contents;  ///< of those that come
  std::set<KeptPath> largest;           ///< as many as the batch may have to drop
};

/// A digest of a robot with the name of a task.
using PairName = std::pair<Digest, std::string>;

struct BatchKnowledge {
  std::map<Digest, KnownRobot> robots;  ///< that are registered
  std::map<Uuid, EarlierReport> reports;
  std::set<Uuid> retired;  ///< reports whose path somebody retired, here or elsewhere
  std::map<PairName, Pair> pairs;
  std::map<Digest, bool> scenes;       ///< by content: whether it can be read
  std::vector<std::int64_t> path_ids;  ///< for the new ones; one for each attempt with a path
};

using PreparedAttempts = std::span<const PreparedAttempt* const>;

/// Reads what is known, and locks: first the robots, then the pairs, each in the order of ids, so
/// that writers wait for each other in turn and never in a circle. In a writing transaction.
/// \param max_paths  of a pair (retention); 0: no cap.
BatchKnowledge learn(Connection& connection, PreparedAttempts attempts, std::uint64_t max_paths);

/// What the checksum of a path will be once it is dropped.
std::uint32_t crc_when_dropped(Bytes report_uuid, Bytes T_task_base, std::int64_t dof,
                               std::int64_t waypoint_count);

/// Whether a report is the one that came before. Its machine may be called otherwise since: by the
/// name in a certificate that it had not then, or has not any more.
bool is_again(const PreparedAttempt& prepared, const EarlierReport& earlier);

}  // namespace kinship::store::postgres
