#pragma once

#include <filesystem>

#include "proto/types/result.hpp"

namespace kinship::store {

/// A file that has its name only once it is complete: it is written as
/// FILE.kinship-XXXXXXXX.part, a name that nobody has, for its owner alone, and removed with
/// everything that SQLite laid beside it unless it is published.
class NewFile {
 public:
  /// Removes what killed processes left of the same file: by its name, owner and content; whatever
  /// else has such a name stays.
  /// \throws Failure(Conflict) if the file is there already, or another process is writing it;
  ///         Failure(Storage) if it cannot be made. Both name the file.
  explicit NewFile(std::filesystem::path file);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  const std::filesystem::path& file() const noexcept { return file_; }
  const std::filesystem::path& part() const noexcept { return part_; }

  /// Brings what was written so far to the disk. \throws Failure(Storage).
  void sync() const;

  /// Syncs the file, gives it its name without replacing another, and syncs the directory.
  /// \throws Failure(Conflict) if somebody made a file of that name meanwhile; Failure(Storage).
  void publish();

 private:
  [[noreturn]] void fail(const std::string& doing, int error) const;

  std::filesystem::path file_;
  std::filesystem::path part_;
  int descriptor_ = -1;
  bool published_ = false;
};

/// Renames without replacing. \return 0, or errno: EEXIST if `to` is there.
int rename_new(const std::filesystem::path& from, const std::filesystem::path& to);

/// Brings a file to the disk. \throws Failure(Storage).
void sync_file(const std::filesystem::path& file);

/// Makes the names in the directory of `file` durable. \throws Failure(Storage).
void sync_directory_of(const std::filesystem::path& file);

/// The files that SQLite keeps beside a database.
inline constexpr const char* kCompanions[] = {"-wal", "-shm", "-journal"};

}  // namespace kinship::store
