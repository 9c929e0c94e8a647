#pragma once

#include <string>

#include "proto/types/result.hpp"
#include "server/service/backup_files.hpp"
#include "server/service/jobs.hpp"
#include "server/store/admin_store.hpp"

namespace kinship::service {

/// The job that copies the store into a new file in the folder of backups.
/// \param store  outlives the job.
/// \param name   bare (find_name_fault); not that of an existing file, link or folder.
/// \param request_key  see Jobs::Task.
/// \return InvalidInput or Conflict that names the file and its fault; Unavailable, with both
///         sizes, if there is no room for it.
Result<Jobs::Task> backup_job(const store::AdminStore& store, const std::string& name,
                              const BackupPlace& place, const std::string& request_key);

}  // namespace kinship::service
