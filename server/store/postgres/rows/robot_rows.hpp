#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"
#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"

/// Robots, with their parts. What writes does so in a writing transaction, and locks the robot's
/// row before anything of its pairs.
namespace kinship::store::postgres {

/// Whether a robot is registered, and its row whole.
bool is_registered(Connection& connection, const Digest& robot);

/// As Store::register_robot(), replace_geometry() and rename_robot() say.
Result<RegisterStatus> insert_robot(Connection& connection, const RobotRecord& robot);
bool update_robot(Connection& connection, const RobotRecord& robot);
Result<bool> relabel_robot(Connection& connection, const Digest& robot, const std::string& label);

/// Removes the row of a robot that nothing refers to, and its parts.
void delete_robot(Connection& connection, std::int64_t robot_id);

/// Keeps others from changing a robot, or writing reports of it, for the rest of the transaction.
/// \return its id; nothing if its digest is not known.
std::optional<std::int64_t> lock_robot(Connection& connection, const Digest& robot);

std::map<Digest, std::uint64_t> select_geometry_revisions(Connection& connection);

/// Nothing if it is not registered. \throws Failure(Storage) if its row is damaged.
std::optional<RobotRecord> select_robot(Connection& connection, const Digest& robot);

struct RobotsRead {
  std::vector<RobotRecord> robots;   ///< by label
  std::vector<std::string> damaged;  ///< labels
};
RobotsRead select_robots(Connection& connection);

}  // namespace kinship::store::postgres
