#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/audit.hpp"
#include "proto/types/result.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// Robots, with their parts. Functions that write use the caller's transaction, and lock the robot
/// before its experience.
namespace kinship::store {

/// Whether a robot is registered and its row undamaged.
bool is_registered(Session& session, const Digest& robot);

/// The id of a robot that is not removed; its row may be damaged. From indexes.
std::optional<std::int64_t> find_registered(Session& session, const Digest& robot);

/// Whether a robot's row is as it was written.
bool is_robot_readable(Session& session, std::int64_t id);

/// Registers a robot. The row of a damaged or removed robot is written anew under its id, so that
/// its paths stay.
/// \return Known if the digest is registered, undamaged; Conflict if another robot has the label.
Result<RegisterStatus> insert_robot(Session& session, const RobotRecord& robot);

/// As Store::replace_geometry() says.
bool update_robot(Session& session, const RobotRecord& robot);

/// As Store::rename_robot() says, for any free label.
Result<bool> relabel_robot(Session& session, const Digest& robot, const std::string& label);

/// The same with an entry in the audit log; no entry without `audit`.
Result<bool> rename_audited(Session& session, const Digest& robot, const std::string& label,
                            const AuditEntry* audit);

/// Deletes a robot's row and its parts. Precondition: no row refers to it.
void delete_robot(Session& session, std::int64_t robot_id);

/// Keeps other servers from changing a robot, or writing reports of it, until the transaction ends.
/// \return its id; nothing if its digest is not known.
std::optional<std::int64_t> lock_robot(Session& session, const Digest& robot);

std::map<Digest, std::uint64_t> select_geometry_revisions(Session& session);

/// Nothing if it is not registered. \throws Failure(Storage) if its row is damaged.
std::optional<RobotRecord> select_robot(Session& session, const Digest& robot);

/// Robots in order of labels without removed ones, and the labels of robots with damaged rows.
struct RobotsRead {
  std::vector<RobotRecord> robots;
  std::vector<std::string> damaged;
};
RobotsRead select_robots(Session& session);

/// In order of labels, without removed ones; of a robot with a damaged row its name alone.
/// \param cursor  the label of the last robot shown.
Page<RobotSummary> page_of_robots(Session& session, std::string_view cursor, std::size_t limit);

/// Digest and label of a robot.
struct RobotName {
  Digest digest;
  std::string label;
};
/// Of all robots, removed ones too, by their internal ids. A damaged row has the name that indexes
/// have of it.
std::map<std::int64_t, RobotName> select_robot_names(Session& session);

}  // namespace kinship::store
