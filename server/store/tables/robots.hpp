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

/// Robots, with their parts. Functions that write do so in the caller's transaction, and lock the
/// robot before anything of its experience.
namespace kinship::store {

/// Whether a robot is registered, and its row whole.
bool is_registered(Session& session, const Digest& robot);

/// The id of a robot that is not removed, its row may be damaged. From indexes.
std::optional<std::int64_t> find_registered(Session& session, const Digest& robot);

/// Writes a damaged or removed robot's row anew, under its id, so that its paths stay.
/// \return Known if the digest is there, undamaged; Conflict if another robot has the label.
Result<RegisterStatus> insert_robot(Session& session, const RobotRecord& robot);

/// As Store::replace_geometry() says.
bool update_robot(Session& session, const RobotRecord& robot);

/// As Store::rename_robot() says, for any label that is free.
Result<bool> relabel_robot(Session& session, const Digest& robot, const std::string& label);

/// The same with an entry of the audit log; none without `audit`.
Result<bool> rename_audited(Session& session, const Digest& robot, const std::string& label,
                            const AuditEntry* audit);

/// A robot's row and its parts; nothing may refer to it any more.
void delete_robot(Session& session, std::int64_t robot_id);

/// Keeps others from changing a robot, or writing reports of it, for the rest of the transaction.
/// \return its id; nothing if its digest is not known.
std::optional<std::int64_t> lock_robot(Session& session, const Digest& robot);

std::map<Digest, std::uint64_t> select_geometry_revisions(Session& session);

/// Nothing if it is not registered. \throws Failure(Storage) if its row is damaged.
std::optional<RobotRecord> select_robot(Session& session, const Digest& robot);

/// Robots by label without removed ones, and the labels of those whose rows are damaged.
struct RobotsRead {
  std::vector<RobotRecord> robots;
  std::vector<std::string> damaged;
};
RobotsRead select_robots(Session& session);

/// By label, without removed ones. \param cursor  the label of the last robot shown.
Page<RobotSummary> page_of_robots(Session& session, std::string_view cursor, std::size_t limit);

/// What a robot is called.
struct RobotName {
  Digest digest;
  std::string label;
};
/// Of all robots, removed ones too, by their internal ids. From indexes: a damaged row has its
/// name.
std::map<std::int64_t, RobotName> select_robot_names(Session& session);

}  // namespace kinship::store
