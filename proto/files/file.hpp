#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::files {

/// The operation that the system refused.
enum class Step { Make, Open, Read, Write, Sync, SyncFolder, Name, Lock };

/// A file that the system refused: "file 'F': cannot be written: No space left on device". Conflict
/// if a file or a process is in the way, otherwise Storage. A caller with other messages catches
/// it.
class FileError : public Failure {
 public:
  FileError(std::filesystem::path file, Step step, int reason);

  const std::filesystem::path& file() const noexcept { return file_; }
  Step step() const noexcept { return step_; }
  int reason() const noexcept { return reason_; }  ///< an errno
  std::string reason_text() const;                 ///< the system's text

 private:
  std::filesystem::path file_;
  Step step_;
  int reason_;
};

/// The sole owner of an open file. Its methods throw FileError and continue after an interrupt.
class File {
 public:
  /// \param flags  of open(2); O_CLOEXEC is added. A failure with O_EXCL has Step::Make.
  /// \param mode   of a new file, restricted by the umask.
  /// \param named  in messages, instead of `path`.
  explicit File(const std::filesystem::path& path, int flags, mode_t mode = 0,
                const std::filesystem::path& named = {});
  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File();

  int descriptor() const noexcept { return descriptor_; }
  std::uint64_t size() const;  ///< bytes
  void write(std::string_view bytes, std::uint64_t place) const;
  std::size_t read(char* bytes, std::size_t size, std::uint64_t place) const;  ///< 0: the end
  void resize(std::uint64_t size) const;
  void sync(Step step = Step::Sync) const;

  /// Takes the file's exclusive lock (flock), which ends with the last process that has the file
  /// open through this object. \return false if another owner holds it.
  bool try_lock() const;
  void lock() const;  ///< waits for it

 private:
  [[noreturn]] void fail(Step step) const;  ///< with errno

  int descriptor_;  // -1: moved from
  std::filesystem::path named_;
};

/// \throws FileError if the file cannot be read, Failure(TooLarge) above `limit` bytes.
std::string read_file(const std::filesystem::path& file, std::size_t limit);

/// The same for a file that a stranger may have put there: whatever is no regular file (a folder, a
/// FIFO, a device) is not waited for. \throws Failure(Storage) that says so.
std::string read_regular_file(const std::filesystem::path& file, std::size_t limit);

/// Renames without replacing. \return 0, or errno: EEXIST if `to` is there.
int rename_new(const std::filesystem::path& from, const std::filesystem::path& to);

/// Syncs a file to the disk. \throws FileError.
void sync_file(const std::filesystem::path& file);

/// Makes the names in the folder of `file` durable. \throws FileError that names the folder.
void sync_folder_of(const std::filesystem::path& file);

}  // namespace kinship::files
