#include "server/service/backup_job.hpp"

#include <optional>
#include <system_error>

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

std::optional<Error> check(const fs::path& file, const fs::path& store_file) {
  if (!file.is_absolute())
    return refused(ErrorCode::InvalidInput, file,
                   "the name must begin with '/': it is a file at the server");
  std::error_code error;
  const fs::file_status status = fs::symlink_status(file, error);
  if (fs::is_directory(status) || file.filename().empty())
    return refused(ErrorCode::InvalidInput, file, "is a folder; name a file in it");
  if (belongs_to_store(file, store_file))
    return refused(ErrorCode::InvalidInput, file,
                   "belongs to the store '" + store_file.string() + "'");
  if (fs::exists(status))
    return refused(ErrorCode::Conflict, file, "is there already");
  if (!fs::is_directory(file.parent_path(), error))
    return refused(ErrorCode::InvalidInput, file,
                   "there is no folder '" + file.parent_path().string() + "'");
  return std::nullopt;
}

bool run_backup(const store::Store& store, const fs::path& file, JobRun& run) {
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

Result<Jobs::Task> backup_job(const store::Store& store, const std::string& file,
                              const std::string& request_key) {
  if (const auto error = check(file, store.status().file))
    return *error;
  return Jobs::Task{
      .verb = "backup",
      .argument = file,
      .request_key = request_key,
      .run = [&store, path = fs::path(file)](JobRun& run) { return run_backup(store, path, run); }};
}

}  // namespace kinship::service
