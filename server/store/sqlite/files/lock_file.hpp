#pragma once

#include <filesystem>

namespace kinship::store {

/// Holds FILE.lock exclusively while it lives, so that one process writes one store. The lock ends
/// with the process, however that ends; the file stays, with the process id of its last holder.
class LockFile {
 public:
  /// \param store_file  the lock is taken beside it, at `store_file` + ".lock".
  /// \throws Failure(Unavailable) naming the holder's process id if another process holds it;
  ///         Failure(Storage) if the file cannot be made.
  explicit LockFile(const std::filesystem::path& store_file);
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;
  ~LockFile();

 private:
  int descriptor_;
};

}  // namespace kinship::store
