#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "proto/files/file.hpp"
#include "proto/types/failure.hpp"

namespace kinship::store {

/// The failure of a store whose names lead elsewhere.
class NotTheFile : public Failure {
 public:
  explicit NotTheFile(const std::string& message) : Failure(ErrorCode::Storage, message) {}
};

/// What became of the files of an open store.
enum class StoreChange {
  None,
  FolderGone,   ///< the file is whole in its folder, to which its name no longer leads
  FileGone,     ///< the name leads to no file, or to another one
  Truncated,    ///< the file lost its end
  Overwritten,  ///< the file has other bytes than SQLite wrote
  WalGone,      ///< no WAL has the name
  WalReplaced,  ///< another file has the name of the WAL
  WalDamaged,   ///< the WAL lost transactions, or has other bytes than SQLite wrote
  WalSpent,     ///< the same, but all of them are in the file already
};

/// Whether the files themselves were changed, not what their names lead to.
bool is_of_content(StoreChange change);

/// Whether the names of an open store (FILE, FILE-wal) still lead to the files that are open: to be
/// asked again and again, each time a few calls of the system. A name may be taken from a file at
/// any time, and then everything is written where nobody finds it. Used by one thread at a time.
/// Methods throw FileError if the system does not say what a name leads to.
class NamedStore {
 public:
  struct Finding {
    StoreChange change = StoreChange::None;
    std::string text;  ///< "it was removed"; empty for None
  };

  /// \param file  of locate_store().
  /// \param open  the store's file, open as long as this object lives.
  NamedStore(std::filesystem::path file, const files::File& open);

  /// Notes the WAL and the size, of a store that was just opened for writing.
  void note_opened();

  /// While the store is open.
  Finding look();
  /// Before it is opened again: a WAL that is missing or empty is none, then.
  Finding look_closed();

  const files::File& file() const noexcept { return *open_; }
  /// As it was opened; null if it had no name then.
  const files::File* wal() const noexcept { return log_ ? &*log_ : nullptr; }
  const std::filesystem::path& wal_path() const noexcept { return wal_; }

  /// Whether any name leads to the file: it was moved, not removed.
  bool has_name() const;
  /// "/proc/7/fd/3 (the file) and /proc/7/fd/9 (its WAL)": while this process lives.
  std::string open_files() const;

  /// Where the folder of the store is now; empty if nowhere, or below a mount.
  std::filesystem::path folder_now() const;

 private:
  struct Id {
    dev_t device = 0;
    ino_t inode = 0;
    bool operator==(const Id&) const = default;
  };

  static Id id_of(const struct stat& status);
  Finding look_at_file();
  bool is_truncated(std::uint64_t size);
  bool is_whole_in_folder() const;

  const std::filesystem::path file_;
  const std::filesystem::path wal_;
  const files::File* open_;
  const Id id_;  // of the open file
  const files::File folder_;
  std::uint64_t size_ = 0;          // of the file, so far
  std::optional<files::File> log_;  // the WAL: while it is open no other file gets its number
  Id log_id_;
};

}  // namespace kinship::store
