#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/types/audit.hpp"
#include "server/store/store.hpp"

/// What entries of the audit log say of an act.
namespace kinship::store {

/// An entry whose texts fit.
AuditEntry cut_to_fit(AuditEntry entry);

/// What an entry says of an act beyond who asked for what.
AuditEntry entry_of_act(const AuditEntry& asked, AuditOutcome outcome, std::string before,
                        std::string after);

/// What kinshipd did to a store by itself, or by a verb of its command line.
AuditEntry entry_of_maintenance(const std::string& verb, const std::string& store,
                                const std::string& before, const std::string& after);

/// \param before, after  versions of the schema.
AuditEntry entry_of_migration(const std::string& store, std::int64_t before, std::int64_t after);

/// "1 path", "2 paths".
std::string in_number(std::int64_t count, const std::string& noun);

std::string describe_paths(std::string_view task, std::int64_t paths);

/// A robot as it is before it is removed.
std::string describe_robot(std::string_view label, const Digest& robot, std::int64_t paths,
                           std::int64_t attempts);

std::string describe_removal(const RobotRemoval& removal);

/// A distribution as it is before it is evicted.
std::string describe_distribution(const Distribution& distribution);

}  // namespace kinship::store
