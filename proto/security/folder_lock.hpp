#pragma once

#include <filesystem>

namespace kinship::security {

/// As long as one lives, nobody else has one of the same folder, in whatever process: what is read
/// of the folder and then written is not changed by others in between.
class FolderLock {
 public:
  /// Waits until nobody else has one.
  /// \throws Failure(Storage) if the folder's file `lock` cannot be had.
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int file_;
};

}  // namespace kinship::security
