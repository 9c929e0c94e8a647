#include "server/service/backup_job.hpp"

#include <optional>
#include <system_error>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::service {
namespace {

namespace fs = std::filesystem;

Error refused(ErrorCode code, const fs::path& file, const std::string& why) {
  return {code, "backup '" + file.string() + "': " + why};
}

/// A copy is at most as large as the store with the pages of its WAL.
std::optional<Error> check_room(const fs::path& file, const store::AdminStore& store,
                                const BackupPlace& place) {
  const std::uint64_t needed = store.status().bytes;
  const std::uint64_t free = place.free_bytes(file.parent_path());
  if (needed <= free)
    return std::nullopt;
  return refused(ErrorCode::Unavailable, file,
                 "needs up to " + std::to_string(needed) + " bytes, but its file system has " +
                     std::to_string(free) + " left");
}

std::optional<Error> check(const fs::path& file, const store::AdminStore& store,
                           const BackupPlace& place) {
  std::error_code error;
  if (!fs::is_directory(file.parent_path(), error))
    return refused(
        ErrorCode::InvalidInput, file,
        "there is no folder '" + file.parent_path().string() + "' (kinshipd --backup-folder)");
  const fs::file_status status = fs::symlink_status(file, error);
  if (fs::exists(status))  // a link that leads nowhere, too
    return refused(ErrorCode::Conflict, file, "is there already");
  return check_room(file, store, place);
}

bool run_backup(const store::AdminStore& store, const fs::path& file, const BackupPlace& place,
                JobRun& run) {
  if (const auto error = check(file, store, place))  // it may have waited
    throw Failure(*error);
  const bool complete = store
                            .backup(file,
                                    [&run](double progress) {
                                      run.set_progress(progress);
                                      return !run.should_stop();
                                    })
                            .value_or_throw();
  std::error_code error;
  const std::uintmax_t bytes = complete ? fs::file_size(file, error) : 0;
  if (complete)
    run.message = "'" + file.string() + "', " + std::to_string(bytes) + " bytes";
  return complete;
}

}  // namespace

Result<Jobs::Task> backup_job(const store::AdminStore& store, const std::string& name,
                              const BackupPlace& place, const std::string& request_key) {
  const fs::path store_file = store.status().file;
  if (auto fault = find_name_fault(name, store_file))
    return *std::move(fault);
  const Result<fs::path> folder = folder_of(place, store_file);
  if (!folder)
    return folder.error();
  const fs::path path = *folder / name;
  if (const auto error = check(path, store, place))
    return *error;
  return Jobs::Task{
      .verb = "backup",
      .argument = path.string(),
      .request_key = request_key,
      .run = [&store, path, place](JobRun& run) { return run_backup(store, path, place, run); }};
}

}  // namespace kinship::service
