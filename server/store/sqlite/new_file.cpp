#include "server/store/sqlite/new_file.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

void remove_companions(const fs::path& file) {
  for (const char* const companion : kCompanions)
    unlink((file.string() + companion).c_str());
}

/// Whether the open file still has this name: its owner may have given it another one.
bool is_named(int descriptor, const fs::path& name) {
  struct stat open_file {};
  struct stat named_file {};
  return fstat(descriptor, &open_file) == 0 && lstat(name.c_str(), &named_file) == 0 &&
         open_file.st_dev == named_file.st_dev && open_file.st_ino == named_file.st_ino;
}

void sync_opened(const fs::path& name, int flags, const std::string& kind) {
  const int descriptor = open(name.c_str(), flags);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  const int reason = errno;
  if (descriptor >= 0)
    close(descriptor);
  if (!synced)
    throw Failure(ErrorCode::Storage, kind + " '" + name.string() + "': " + std::strerror(reason));
}

}  // namespace

NewFile::NewFile(fs::path file) : file_(std::move(file)), part_(file_.string() + ".part") {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(file_, error).type();
  if (type != fs::file_type::not_found && type != fs::file_type::none)
    throw Failure(ErrorCode::Conflict, "file '" + file_.string() + "': is there already");
  constexpr mode_t kOwnerOnly = 0600;
  descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kOwnerOnly);
  if (descriptor_ < 0)
    fail("cannot be made", errno);
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 || !is_named(descriptor_, part_)) {
    close(descriptor_);
    throw Failure(ErrorCode::Conflict,
                  "file '" + file_.string() + "': somebody else is writing it");
  }
  remove_companions(part_);
  if (ftruncate(descriptor_, 0) != 0 || fchmod(descriptor_, kOwnerOnly) != 0) {
    const int reason = errno;
    close(descriptor_);
    fail("cannot be made", reason);
  }
}

NewFile::~NewFile() {
  if (!published_) {
    unlink(part_.c_str());
    remove_companions(part_);
  }
  close(descriptor_);
}

void NewFile::sync() const {
  if (fsync(descriptor_) != 0)
    fail("cannot be written", errno);
}

void NewFile::publish() {
  sync();
  if (const int error = rename_new(part_, file_); error == EEXIST)
    throw Failure(ErrorCode::Conflict, "file '" + file_.string() + "': is there already");
  else if (error != 0)
    fail("cannot be named", error);
  published_ = true;
  sync_directory_of(file_);
}

void NewFile::fail(const std::string& doing, int error) const {
  throw Failure(ErrorCode::Storage,
                "file '" + file_.string() + "': " + doing + ": " + std::strerror(error));
}

int rename_new(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0)
    return 0;
  if (errno != EINVAL && errno != ENOSYS)
    return errno;
  // Not every file system can do that; a second name is refused if there is one.
  if (link(from.c_str(), to.c_str()) != 0)
    return errno;
  return unlink(from.c_str()) == 0 ? 0 : errno;
}

void sync_file(const fs::path& file) { sync_opened(file, O_RDONLY | O_CLOEXEC, "file"); }

void sync_directory_of(const fs::path& file) {
  sync_opened(fs::absolute(file).parent_path(), O_RDONLY | O_DIRECTORY | O_CLOEXEC, "directory");
}

}  // namespace kinship::store
