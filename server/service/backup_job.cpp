#include "server/service/backup_job.hpp"

#include <algorithm>
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

/// SQLite's companions of the store come and go beside it, its lock stays, and copies that a
/// migration keeps have their names from it too.
bool belongs_to_store(const fs::path& file, const fs::path& store_file) {
  std::error_code no_folder;
  return fs::equivalent(file.parent_path(), fs::absolute(store_file).parent_path(), no_folder) &&
         file.filename().string().starts_with(store_file.filename().string());
}

/// Whether a folder is the other one or below it, symbolic links followed.
bool is_within(const fs::path& folder, const fs::path& outer) {
  std::error_code error;
  const fs::path inner = fs::canonical(folder, error);
  const fs::path whole = fs::canonical(outer, error);
  return !error &&
         std::mismatch(whole.begin(), whole.end(), inner.begin(), inner.end()).first == whole.end();
}

/// A copy is at most as large as the store and what waits beside it to go into it.
std::optional<Error> check_room(const fs::path& file, const store::Store& store,
                                const BackupPlace& place) {
  const std::uint64_t needed = store.status().bytes;
  const std::uint64_t free = place.free_bytes(file.parent_path());
  if (needed <= free)
    return std::nullopt;
  return refused(ErrorCode::Unavailable, file,
                 "needs up to " + std::to_string(needed) + " bytes, but its file system has " +
                     std::to_string(free) + " left");
}

std::optional<Error> check(const fs::path& file, const store::Store& store,
                           const BackupPlace& place) {
  const fs::path store_file = store.status().file;
  std::error_code error;
  const fs::file_status status = fs::symlink_status(file, error);
  if (fs::is_directory(status) || file.filename().empty())
    return refused(ErrorCode::InvalidInput, file, "is a folder; name a file in it");
  if (!fs::is_directory(file.parent_path(), error))
    return refused(ErrorCode::InvalidInput, file,
                   "there is no folder '" + file.parent_path().string() + "'");
  if (!is_within(file.parent_path(), place.folder))
    return refused(ErrorCode::InvalidInput, file,
                   "is outside of '" + place.folder.string() +
                       "', where this server puts backups (kinshipd --backup-folder)");
  if (belongs_to_store(file, store_file))
    return refused(ErrorCode::InvalidInput, file,
                   "belongs to the store '" + store_file.string() + "'");
  if (fs::exists(status))
    return refused(ErrorCode::Conflict, file, "is there already");
  return check_room(file, store, place);
}

bool run_backup(const store::Store& store, const fs::path& file, const BackupPlace& place,
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

std::uint64_t free_bytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? 0 : space.available;
}

Result<Jobs::Task> backup_job(const store::Store& store, const std::string& file, BackupPlace place,
                              const std::string& request_key) {
  if (place.folder.empty())
    place.folder = fs::absolute(fs::path(store.status().file)).parent_path();
  // By itself a name is one in the folder; an absolute one stays what it is.
  const fs::path path = place.folder / file;
  if (file.empty())
    return refused(ErrorCode::InvalidInput, file, "has no name");
  if (const auto error = check(path, store, place))
    return *error;
  return Jobs::Task{.verb = "backup",
                    .argument = path.string(),
                    .request_key = request_key,
                    .run = [&store, path, place = std::move(place)](JobRun& run) {
                      return run_backup(store, path, place, run);
                    }};
}

}  // namespace kinship::service
