#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/result.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/store.hpp"

namespace kinship::store {

/// Writes a damaged row of the digest anew, under its id, so that its paths stay.
/// \return Known if the digest is there, undamaged; Conflict if another robot has the label.
Result<RegisterStatus> insert_robot(Database& database, const RobotRecord& robot);

/// As Store::replace_geometry() says.
bool update_robot(Database& database, const RobotRecord& robot);

std::map<Digest, std::uint64_t> select_geometry_revisions(Database& database);

/// \throws Failure(Storage) if the row is damaged.
std::optional<RobotRecord> select_robot(Database& database, const Digest& robot);

/// Robots by label, and the labels of those whose rows are damaged.
struct RobotsRead {
  std::vector<RobotRecord> robots;
  std::vector<std::string> damaged;
};
/// \param has_geometry  false of a store from before schema 5.
RobotsRead select_robots(Database& database, bool has_geometry = true);

}  // namespace kinship::store
