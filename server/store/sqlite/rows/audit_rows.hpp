#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "proto/types/audit.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/rows/retirement.hpp"
#include "server/store/store.hpp"

/// The audit log: rows are added, never changed (triggers of the schema see to it). And what is
/// done for administrators, each with its entry in the same transaction; without `audit` none is
/// kept.
namespace kinship::store {

/// Adds an entry, of now; its number is given here. Texts are cut to what fits.
void insert_audit(Database& database, const AuditEntry& entry);

/// Adds what was done to the store as a whole, by the user of this process and at no client's wish.
void note_maintenance(Database& database, const std::string& verb,
                      const std::filesystem::path& target, const std::string& before,
                      const std::string& after);

/// Adds the entries that the log of `other` has and that of `database` has not, in their order,
/// with the times that they have. Of what is no store none.
void copy_missing_audit(Database& database, Database& other);

/// As Store::rename_robot() says.
Result<bool> rename_audited(Database& database, const Digest& robot, const std::string& label,
                            const AuditEntry* audit);

/// As continue_removal(); where it takes several transactions the first one says Begun.
Result<bool> remove_audited(Batch& batch, const Digest& robot, RemovedRobot& removed,
                            const AuditEntry* audit);

/// As retire_path().
Result<Retirement> retire_audited(Batch& batch, const Uuid& report_uuid, const AuditEntry* audit);

/// As begin_reset(), with the entry that says Begun.
Result<TaskReset> begin_reset_audited(Database& database, std::string_view task,
                                      const AuditEntry* audit);

/// As continue_reset(), with the entry that says Done in the transaction that finds no path left.
bool continue_reset_audited(Batch& batch, const TaskReset& reset, Retirement& retired,
                            const AuditEntry* audit);

/// As delete_distribution(); no entry if it was not there.
bool evict_audited(Database& database, const Digest& id, const AuditEntry* audit);

}  // namespace kinship::store
