#pragma once

#include <span>

#include "proto/files/file.hpp"

namespace kinship::files {

/// Options of a new file.
struct NewFileOptions {
  mode_t mode = 0600;        ///< restricted by the umask
  bool may_replace = false;  ///< a file of that name
  bool is_durable = true;    ///< published content and name survive a power cut

  /// First bytes of files of this kind. If set, one process at a time writes a file, and leftovers
  /// of killed processes are removed first: parts of this user that are empty or begin like this.
  /// Otherwise they stay.
  std::string_view magic = {};
  std::span<const char* const> sidecars =
      {};  ///< suffixes of files that go with an unpublished one
};

/// A file that has its name only once it is complete. It is written as FILE.kinship-XXXXXXXX.part,
/// a name that no other file has, which is removed with its sidecars unless it is published.
class NewFile {
 public:
  /// \throws FileError that names the file: a Conflict if it exists and may not be replaced, or if
  ///         another process is writing it.
  explicit NewFile(std::filesystem::path file, const NewFileOptions& options = {});
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  const std::filesystem::path& part() const noexcept { return part_; }

  /// Writes the content, and the time of writing, so that times of files of one process are in
  /// order. \throws FileError.
  void write(std::string_view content) const;

  /// Syncs the content so far to the disk. \throws FileError.
  void sync() const { open_.sync(); }

  /// Gives the file its name; durable unless the options say otherwise.
  /// \throws FileError: a Conflict if a file of that name was made meanwhile.
  void publish();

 private:
  File make_part();

  std::filesystem::path file_;
  NewFileOptions options_;
  std::filesystem::path part_;
  File open_;
  bool is_published_ = false;
};

/// Writes a whole file: a reader has the old content, or none, or all of the new one.
/// \throws FileError.
void write_file(const std::filesystem::path& file, std::string_view content,
                const NewFileOptions& options);

/// Whether the name is that of an unpublished file, whose writer may have been killed.
bool is_part(const std::filesystem::path& path);

}  // namespace kinship::files
