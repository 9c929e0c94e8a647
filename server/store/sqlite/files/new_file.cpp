#include "server/store/sqlite/files/new_file.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <string>
#include <utility>

#include "proto/types/uuid.hpp"

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

constexpr const char* kPartInfix = ".kinship-";
constexpr const char* kPartSuffix = ".part";
constexpr std::size_t kPartDigits = 8;

/// The name of the part that an entry of the folder of `file` is, or lies beside; empty: it has
/// nothing to do with it.
std::string part_of(const fs::path& file, const std::string& entry) {
  const std::string prefix = file.filename().string() + kPartInfix;
  const std::size_t size = prefix.size() + kPartDigits + std::strlen(kPartSuffix);
  const std::string part = entry.substr(0, size);
  const std::string digits = part.substr(std::min(prefix.size(), part.size()), kPartDigits);
  const bool is_part = part.size() == size && part.starts_with(prefix) &&
                       part.ends_with(kPartSuffix) &&
                       digits.find_first_not_of("0123456789abcdef") == std::string::npos;
  return is_part ? part : std::string();
}

/// Whether the file is one that this program began: its user's, empty or a database.
bool is_ours(int descriptor) {
  constexpr char kMagic[] = "SQLite format 3";
  struct stat status {};
  char begin[sizeof kMagic] = {};
  if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_uid != geteuid())
    return false;
  return status.st_size == 0 || (pread(descriptor, begin, sizeof begin, 0) == sizeof begin &&
                                 std::memcmp(begin, kMagic, sizeof kMagic) == 0);
}

/// \throws Failure(Conflict) if somebody is writing it.
void remove_leftover(const fs::path& file, const fs::path& part) {
  const int descriptor = open(part.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) {
    if (errno == ENOENT)  // its process was killed while it removed it
      remove_companions(part);
    return;
  }
  const bool ours = is_ours(descriptor);
  const bool locked = ours && flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  if (locked && is_named(descriptor, part)) {
    unlink(part.c_str());
    remove_companions(part);
  }
  close(descriptor);
  if (ours && !locked)
    throw Failure(ErrorCode::Conflict, "file '" + file.string() + "': somebody else is writing it");
}

/// What killed processes left of the same file; files of other names or contents stay.
void remove_leftovers(const fs::path& file) {
  const fs::path folder = fs::absolute(file).parent_path();
  std::set<std::string> parts;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (std::string part = part_of(file, entry->path().filename().string()); !part.empty())
      parts.insert(std::move(part));
  for (const std::string& part : parts)
    remove_leftover(file, folder / part);
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

NewFile::NewFile(fs::path file) : file_(std::move(file)) {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(file_, error).type();
  if (type != fs::file_type::not_found && type != fs::file_type::none)
    throw Failure(ErrorCode::Conflict, "file '" + file_.string() + "': is there already");
  remove_leftovers(file_);
  constexpr mode_t kOwnerOnly = 0600;
  part_ = file_.string() + kPartInfix + Uuid::random().text().substr(0, kPartDigits) + kPartSuffix;
  descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, kOwnerOnly);
  if (descriptor_ < 0)
    fail("cannot be made", errno);
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 || fchmod(descriptor_, kOwnerOnly) != 0) {
    const int reason = errno;
    unlink(part_.c_str());
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
