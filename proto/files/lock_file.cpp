#include "proto/files/lock_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <utility>

namespace kinship::files {
namespace {

bool has_name(const File& file, const std::filesystem::path& name) {
  struct stat open {
  }, named{};
  return fstat(file.descriptor(), &open) == 0 && stat(name.c_str(), &named) == 0 &&
         open.st_dev == named.st_dev && open.st_ino == named.st_ino;
}

}  // namespace

LockFile::LockFile(const std::filesystem::path& file, mode_t mode)
    : file_(file, O_RDWR | O_CREAT | O_NOFOLLOW, mode) {}

std::optional<LockFile> LockFile::try_acquire(const std::filesystem::path& file, mode_t mode) {
  while (true) {
    LockFile lock(file, mode);
    if (!lock.file_.try_lock())
      return std::nullopt;
    if (!has_name(lock.file_, file))
      continue;  // its last holder removed it meanwhile
    lock.note_holder();
    return lock;
  }
}

LockFile LockFile::acquire(const std::filesystem::path& file, mode_t mode) {
  LockFile lock(file, mode);
  lock.file_.lock();
  lock.note_holder();
  return lock;
}

/// The process id is for people: without it (a full disk) the lock holds all the same.
void LockFile::note_holder() const {
  try {
    file_.resize(0);
    file_.write(std::to_string(getpid()) + "\n", 0);
  } catch (const FileError&) {
  }
}

std::string LockFile::holder(const std::filesystem::path& file) {
  char text[32] = {};
  const std::string_view holder(text, File(file, O_RDONLY).read(text, sizeof text, 0));
  const std::string digits(holder.substr(0, holder.find_first_not_of("0123456789")));
  return digits.empty() ? "unknown" : digits;
}

}  // namespace kinship::files
