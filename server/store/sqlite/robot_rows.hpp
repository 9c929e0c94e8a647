#pragma once

#include <optional>
#include <vector>

#include "proto/types/result.hpp"
#include "server/store/sqlite/database.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// Writes a damaged row of the digest anew, under its id, so that its paths stay.
/// \return Known if the digest is there, undamaged; Conflict if another robot has the label.
Result<RegisterStatus> insert_robot(Database& database, const RobotRecord& robot);

/// \throws Failure(Storage) if the row is damaged.
std::optional<RobotRecord> select_robot(Database& database, const Digest& robot);

/// Robots by label, and how many more there are whose rows are damaged.
struct RobotsRead {
  std::vector<RobotRecord> robots;
  std::size_t damaged = 0;
};
RobotsRead select_robots(Database& database);

}  // namespace kinship::store
