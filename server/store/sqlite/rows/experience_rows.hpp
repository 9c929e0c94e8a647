#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/attempt.hpp"
#include "server/store/rules/batch_changes.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"

/// One row per robot and task that somebody reported: its generations and its sums.
namespace kinship::store {

/// Digests and labels of robots by their internal ids, read as they are asked for; where a robot's
/// row is damaged, those of all from their indexes. Lives as long as one reading.
class RobotNames {
 public:
  struct Name {
    Digest digest;
    std::string label;
  };
  explicit RobotNames(Database& database) : database_(&database) {}

  /// Null if there is no such robot. Valid until the next call.
  const Name* find(std::int64_t robot_id);

 private:
  void read_all();

  Database* database_;
  bool has_all_ = false;
  std::map<std::int64_t, Name> names_;
};

/// Makes the row of a robot and task unless it is there. \return how many paths are in use.
std::uint64_t ensure_experience(Database& database, const ExperienceKey& key);

/// Adds all but the generation, which the batch raises.
void add_to_experience(Database& database, const ExperienceKey& key, const PairChange& change);

/// Takes paths out of the count.
void uncount_paths(Database& database, const ExperienceKey& key, std::int64_t paths);

/// Nothing if nobody reported an attempt of the robot for the task.
std::optional<ExperienceKey> find_experience(Database& database, const Digest& robot,
                                             std::string_view task);

/// The rows of a robot and a task, each empty for all, by task and robot; from `first` on.
std::vector<ExperienceKey> select_experience(Database& database, const std::optional<Digest>& robot,
                                             std::string_view task,
                                             const ExperienceKey& first = {});

/// 0 if there is none.
std::uint64_t generation_of(Database& database, const Digest& robot, std::string_view task);

/// The robots that have, or had, paths of a task, by digest.
std::vector<ExperienceSummary> experience_of(Database& database, std::string_view task);

AttemptTotals totals_of(Database& database, const Digest& robot, std::string_view task);

}  // namespace kinship::store
