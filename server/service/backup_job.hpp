#pragma once

#include <filesystem>
#include <string>

#include "proto/types/result.hpp"
#include "server/service/jobs.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// The job that copies the store into a new file at the server.
/// \param store  outlives the job.
/// \param file   absolute, in a folder that is there; never a file that is there, nor one that
///               belongs to the store.
/// \param request_key  see Jobs::Task.
/// \return InvalidInput or Conflict that names the file and what is wrong with it.
Result<Jobs::Task> backup_job(const store::Store& store, const std::string& file,
                              const std::string& request_key);

}  // namespace kinship::service
