#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/backup_summary.hpp"
#include "proto/types/result.hpp"

/// The folder of backups, as files. Names in it are bare: a client that may ask for a backup over
/// the network reaches no other folder, and no file that is not a backup.
namespace kinship::service {

/// Bytes that an ordinary user may still write to the folder's file system; 0 if unknown.
std::uint64_t free_bytes(const std::filesystem::path& folder);

/// The place of backups.
struct BackupPlace {
  std::filesystem::path folder;  ///< empty: the folder of the store, if that is a file
  std::function<std::uint64_t(const std::filesystem::path& folder)> free_bytes =
      service::free_bytes;
};

/// The fault of a backup's name, or nothing. Valid: 1 to kMaxBackupNameBytes of A-Z a-z 0-9 _ . -,
/// beginning with a letter or digit, and none of the store's own files.
/// \param store_file  that the server has open.
std::optional<Error> find_name_fault(const std::string& name,
                                     const std::filesystem::path& store_file);

/// The folder of a place for the store with this file; InvalidInput if it has none.
Result<std::filesystem::path> folder_of(const BackupPlace& place,
                                        const std::filesystem::path& store_file);

/// Complete copies in the folder, the newest first: plain files with valid names that have the
/// header of a store, not of another program's database; without the store itself and its files.
/// \throws Failure(Storage) if the folder cannot be read.
std::vector<BackupSummary> find_backups(const std::filesystem::path& folder,
                                        const std::filesystem::path& store_file);

/// A backup that is open for reading: the same bytes even if the file is renamed or removed.
/// Move-only.
class BackupFile {
 public:
  /// No symbolic link is followed.
  /// \return InvalidInput for an invalid name, NotFound if there is no such backup.
  static Result<BackupFile> open(const std::filesystem::path& folder, const std::string& name,
                                 const std::filesystem::path& store_file);
  BackupFile(BackupFile&& other) noexcept;
  BackupFile& operator=(BackupFile&& other) = delete;
  BackupFile(const BackupFile&) = delete;
  BackupFile& operator=(const BackupFile&) = delete;
  ~BackupFile();

  const BackupSummary& summary() const noexcept { return summary_; }

  /// At most `most` bytes from `begin` on, fewer at the end of the file. \throws Failure(Storage).
  std::vector<std::uint8_t> read(std::uint64_t begin, std::size_t most) const;

 private:
  BackupFile(int descriptor, BackupSummary summary);

  int descriptor_;  // -1: moved from
  BackupSummary summary_;
};

}  // namespace kinship::service
