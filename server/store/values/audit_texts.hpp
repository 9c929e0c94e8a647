#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/types/audit.hpp"
#include "server/store/store.hpp"

/// Texts of the entries of the audit log.
namespace kinship::store {

/// The entry with its texts cut to their limits.
AuditEntry cut_to_fit(AuditEntry entry);

/// `asked`, which names the caller and the request, with an outcome and the values before and
/// after.
AuditEntry entry_of_act(const AuditEntry& asked, AuditOutcome outcome, std::string before,
                        std::string after);

/// The entry of a change by kinshipd itself, or by a verb of its command line.
AuditEntry entry_of_maintenance(const std::string& verb, const std::string& store,
                                const std::string& before, const std::string& after);

/// \param before, after  versions of the schema.
AuditEntry entry_of_migration(const std::string& store, std::int64_t before, std::int64_t after);

/// "1 path", "2 paths".
std::string in_number(std::int64_t count, const std::string& noun);

std::string describe_paths(std::string_view task, std::int64_t paths);

/// Describes a robot before its removal.
std::string describe_robot(std::string_view label, const Digest& robot, std::int64_t paths,
                           std::int64_t attempts);

std::string describe_removal(const RobotRemoval& removal);
std::string describe_removal(const TaskRemoval& removal);

/// Describes a distribution before its eviction.
std::string describe_distribution(const Distribution& distribution);

}  // namespace kinship::store
