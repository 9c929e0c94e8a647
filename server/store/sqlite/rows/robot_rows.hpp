#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// Writes a damaged or removed robot's row anew, under its id, so that its paths stay.
/// \return Known if the digest is there, undamaged; Conflict if another robot has the label.
Result<RegisterStatus> insert_robot(Database& database, const RobotRecord& robot);

/// From the index of labels.
bool is_removed(Database& database, const Digest& robot);

/// As Store::rename_robot() says, for any label that is free.
Result<bool> relabel_robot(Database& database, const Digest& robot, const std::string& label);

/// A robot's row and what belongs to it alone; nothing may refer to it any more.
void delete_robot(Database& database, std::int64_t robot_id);

/// As Store::replace_geometry() says.
bool update_robot(Database& database, const RobotRecord& robot);

std::map<Digest, std::uint64_t> select_geometry_revisions(Database& database);

/// Nothing if it is removed. \throws Failure(Storage) if the row is damaged.
std::optional<RobotRecord> select_robot(Database& database, const Digest& robot);

/// Robots by label without removed ones, and the labels of those whose rows are damaged.
struct RobotsRead {
  std::vector<RobotRecord> robots;
  std::vector<std::string> damaged;
};
RobotsRead select_robots(Database& database);

}  // namespace kinship::store
