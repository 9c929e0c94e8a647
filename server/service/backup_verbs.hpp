#pragma once

#include <cstddef>

#include <string>

#include "server/service/admin_page.hpp"
#include "server/service/backup_files.hpp"
#include "server/service/jobs.hpp"
#include "server/store/store.hpp"

/// The admin verbs about backups that are there.
namespace kinship::service {

AdminPage list_backups(const store::Store& store, const BackupPlace& place,
                       const AdminRequest& request);

/// \return NotFound; InvalidInput for a name that is none.
Result<BackupFile> open_backup(const store::Store& store, const BackupPlace& place,
                               const std::string& name);

/// The job that reads a backup through; its rows are the SHA-256 digest of its bytes in hexadecimal
/// digits, and how many there are. From that whoever then reads them (read_backup) sees that they
/// are all there. Reading them needs no job, so that it goes on after a restart, which ends jobs.
Jobs::Task hash_backup_job(BackupFile file, const std::string& request_key);

/// Some bytes of a backup in base64, from a place on; no row behind its end.
AdminPage read_backup(const BackupFile& file, std::size_t begin);

}  // namespace kinship::service
