#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "proto/types/result.hpp"
#include "server/service/jobs.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// How many bytes an ordinary user may still write into a folder's file system; 0 if nobody can
/// tell.
std::uint64_t free_bytes(const std::filesystem::path& folder);

/// Where backups may be written.
struct BackupPlace {
  std::filesystem::path folder;  ///< and below it; empty: the folder of the store
  std::function<std::uint64_t(const std::filesystem::path& folder)> free_bytes =
      service::free_bytes;
};

/// The job that copies the store into a new file at the server.
/// \param store  outlives the job.
/// \param file   a name in the place, or an absolute one below it, in a folder that is there; never
///               a file that is there, nor one that belongs to the store.
/// \param request_key  see Jobs::Task.
/// \return InvalidInput or Conflict that names the file and what is wrong with it; Unavailable,
/// with
///         both numbers, if there is no room for it.
Result<Jobs::Task> backup_job(const store::Store& store, const std::string& file, BackupPlace place,
                              const std::string& request_key);

}  // namespace kinship::service
