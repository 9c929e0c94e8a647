#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "proto/files/lock_file.hpp"

namespace kinship::store {

/// The lock of a store: one process writes one store. It is on the file FILE.lock, which outlives
/// an exchange of the store, and on the store's file itself, which other names of it (a bind mount)
/// lead to as well, and which is held though somebody removes FILE.lock. To be taken before SQLite
/// opens the file and given up after: closing a descriptor of a file drops SQLite's locks on it.
class StoreLock {
 public:
  /// \param located  of locate_store(); the file may be missing, its name is locked all the same.
  /// \throws Failure(Unavailable) with the process that holds it, Failure(Storage) if it cannot be
  ///         locked.
  explicit StoreLock(const std::filesystem::path& located);

  /// The store's file as it was locked; empty if there was none.
  const std::optional<files::File>& file() const noexcept { return file_; }

 private:
  files::LockFile name_;
  std::optional<files::File> file_;
};

}  // namespace kinship::store
