#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/types/audit.hpp"
#include "proto/types/digest.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// The audit log: rows are added, never changed (triggers of the schemas see to it).
namespace kinship::store {

/// Adds an entry with the current time and the next number. Texts are cut to their limits.
void insert_audit(Session& session, const AuditEntry& entry);

/// Adds the entry of an administrator's change; without `audit` nothing.
void note_act(Session& session, const AuditEntry* audit, AuditOutcome outcome, std::string before,
              std::string after = {});

/// Paths of a task that are in use, for entries.
std::int64_t count_paths_of(Session& session, std::string_view task);

/// Describes a robot before its removal, for the entry; empty if its digest is not known.
std::string describe_robot(Session& session, const Digest& robot);

/// The newest first. \param name  only entries of this name; empty: all.
/// \throws Failure(InvalidInput) for a cursor of another listing.
Page<AuditEntry> page_of_audit(Session& session, std::string_view name, std::string_view cursor,
                               std::size_t limit);

}  // namespace kinship::store
