#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "proto/files/lock_file.hpp"

namespace kinship::store {

/// The lock of a store: one process writes one store. It is on the file FILE.lock, which outlives
/// an exchange of the store, and on the store's file itself, which other names of it (a bind mount)
/// lead to as well, and which is held though somebody removes FILE.lock. To be taken before SQLite
/// opens the file and given up after: closing a descriptor of a file drops SQLite's locks on it. A
/// FILE.lock that it made goes with it if there never was a file.
class StoreLock {
 public:
  /// \param located  of locate_store(); the file may be missing, its name is locked all the same.
  /// \param prepare  called once the name is locked, before the file is, which it may make.
  /// \throws Failure(Unavailable) with the process that holds it, Failure(Storage) if it cannot be
  ///         locked.
  explicit StoreLock(
      const std::filesystem::path& located, const std::function<void()>& prepare = [] {});

  /// The store's file as it was locked; empty if there was none.
  const std::optional<files::File>& file() const noexcept { return file_; }

 private:
  class Name {
   public:
    explicit Name(const std::filesystem::path& located);
    Name(const Name&) = delete;
    Name& operator=(const Name&) = delete;
    ~Name();
    void keep() noexcept { is_new_ = false; }

   private:
    const std::filesystem::path located_;
    bool is_new_;
    files::LockFile lock_;
  };
  Name name_;
  std::optional<files::File> file_;
};

}  // namespace kinship::store
