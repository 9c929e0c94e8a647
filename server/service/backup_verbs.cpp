#include "server/service/backup_verbs.hpp"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "proto/types/base64.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::service {
namespace {

/// \return false if it was to stop.
bool hash(const BackupFile& file, JobRun& run) {
  constexpr std::size_t kStep = std::size_t{1} << 20U;
  Sha256 digest;
  const BackupSummary& summary = file.summary();
  for (std::uint64_t place = 0; place < summary.bytes;) {
    if (run.should_stop())
      return false;
    const std::vector<std::uint8_t> bytes = file.read(place, kStep);
    if (bytes.empty())
      throw Failure(ErrorCode::Storage, "backup '" + summary.name + "': became shorter");
    digest.add(std::span<const std::uint8_t>(bytes));
    place += bytes.size();
    run.set_progress(static_cast<double>(place) / static_cast<double>(summary.bytes));
  }
  const std::string hex = digest.finish().hex();
  run.rows.add(hex);
  run.rows.add(std::to_string(summary.bytes));
  run.message = std::to_string(summary.bytes) + " bytes, SHA-256 " + hex;
  return true;
}

}  // namespace

AdminPage list_backups(const store::Store& store, const BackupPlace& place,
                       const AdminRequest& request) {
  const Result<std::size_t> first = row_number(request.cursor);
  if (!first)
    return page_of(first.error());
  const std::filesystem::path store_file = store.status().file;
  const Result<std::filesystem::path> folder = folder_of(place, store_file);
  if (!folder)
    return page_of(folder.error());
  const std::vector<BackupSummary> all = find_backups(*folder, store_file);
  return page_of(all, *first, page_size(request));
}

Result<BackupFile> open_backup(const store::Store& store, const BackupPlace& place,
                               const std::string& name) {
  const std::filesystem::path store_file = store.status().file;
  const Result<std::filesystem::path> folder = folder_of(place, store_file);
  return folder ? BackupFile::open(*folder, name, store_file) : folder.error();
}

Jobs::Task hash_backup_job(BackupFile file, const std::string& request_key) {
  // Shared, for a std::function is copyable.
  const auto shared = std::make_shared<const BackupFile>(std::move(file));
  return Jobs::Task{.verb = "hash backup",
                    .argument = shared->summary().name,
                    .request_key = request_key,
                    .run = [shared](JobRun& run) { return hash(*shared, run); }};
}

AdminPage read_backup(const BackupFile& file, std::size_t begin) {
  const std::vector<std::uint8_t> bytes = file.read(begin, kMaxBackupChunkBytes);
  AdminPage page;
  page.status = AdminStatus::Ok;
  if (!bytes.empty())
    page.rows.emplace_back(TextLine{to_base64(bytes)});
  if (const std::uint64_t end = begin + bytes.size(); !bytes.empty() && end < file.summary().bytes)
    page.next_cursor = std::to_string(end);
  return page;
}

}  // namespace kinship::service
