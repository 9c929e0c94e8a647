#pragma once

#include <optional>

#include "proto/files/file.hpp"

namespace kinship::files {

/// The exclusive lock of a file, for one owner on this machine. It ends with its process in any
/// case; the file stays, with the process id of its last holder.
class LockFile {
 public:
  /// \return empty if another owner holds it.
  /// \throws FileError if the file cannot be made or locked.
  static std::optional<LockFile> try_acquire(const std::filesystem::path& file, mode_t mode = 0600);

  /// Waits until no other owner holds it. \throws FileError.
  static LockFile acquire(const std::filesystem::path& file, mode_t mode = 0600);

  /// \return the process id of the last holder, "unknown" if the file does not say.
  static std::string holder(const std::filesystem::path& file);

 private:
  LockFile(const std::filesystem::path& file, mode_t mode);
  void note_holder() const;

  File file_;
};

}  // namespace kinship::files
