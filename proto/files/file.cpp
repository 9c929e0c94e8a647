#include "proto/files/file.hpp"

#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace kinship::files {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file, Step step, int reason) {
  const std::string named =
      (step == Step::SyncFolder ? "directory '" : "file '") + file.string() + "': ";
  if (reason == EEXIST)
    return named + "is there already";
  if (step == Step::Lock && reason == EWOULDBLOCK)
    return named + "somebody else is writing it";
  constexpr const char* kDoing[] = {"made",    "opened",       "read",  "written",
                                    "written", "synchronized", "named", "locked"};
  return named + "cannot be " + kDoing[static_cast<std::size_t>(step)] + ": " +
         std::generic_category().message(reason);
}

/// The same call again as long as signals interrupt it.
template <typename Call>
auto uninterrupted(Call call) {
  auto result = call();
  while (result < 0 && errno == EINTR)
    result = call();
  return result;
}

}  // namespace

FileError::FileError(fs::path file, Step step, int reason)
    : Failure(reason == EEXIST || reason == EWOULDBLOCK ? ErrorCode::Conflict : ErrorCode::Storage,
              text_of(file, step, reason)),
      file_(std::move(file)),
      step_(step),
      reason_(reason) {}

std::string FileError::reason_text() const { return std::generic_category().message(reason_); }

File::File(const fs::path& path, int flags, mode_t mode, const fs::path& named)
    : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, mode)),
      named_(named.empty() ? path : named) {
  if (descriptor_ < 0)
    fail((flags & O_EXCL) != 0 ? Step::Make : Step::Open);
}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), named_(std::move(other.named_)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(named_, other.named_);
  return *this;
}

File::~File() {
  if (descriptor_ >= 0)
    ::close(descriptor_);  // which ends a lock
}

std::uint64_t File::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0)
    fail(Step::Read);
  return static_cast<std::uint64_t>(status.st_size);
}

void File::write(std::string_view bytes, std::uint64_t place) const {
  while (!bytes.empty()) {
    const ssize_t written = uninterrupted([&] {
      return ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(place));
    });
    if (written < 0)
      fail(Step::Write);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    place += static_cast<std::uint64_t>(written);
  }
}

std::size_t File::read(char* bytes, std::size_t size, std::uint64_t place) const {
  const ssize_t count =
      uninterrupted([&] { return ::pread(descriptor_, bytes, size, static_cast<off_t>(place)); });
  if (count < 0)
    fail(Step::Read);
  return static_cast<std::size_t>(count);
}

void File::resize(std::uint64_t size) const {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0)
    fail(Step::Write);
}

void File::sync(Step step) const {
  if (::fsync(descriptor_) != 0)
    fail(step);
}

bool File::try_lock() const {
  if (uninterrupted([&] { return ::flock(descriptor_, LOCK_EX | LOCK_NB); }) == 0)
    return true;
  if (errno != EWOULDBLOCK)
    fail(Step::Lock);
  return false;
}

void File::lock() const {
  if (uninterrupted([&] { return ::flock(descriptor_, LOCK_EX); }) != 0)
    fail(Step::Lock);
}

void File::fail(Step step) const { throw FileError(named_, step, errno); }

namespace {

std::string read_whole(const File& file, const fs::path& path, std::size_t limit) {
  std::string content;
  char buffer[16 * 1024];
  while (const std::size_t count = file.read(buffer, sizeof buffer, content.size())) {
    content.append(buffer, count);
    if (content.size() > limit)
      throw Failure(ErrorCode::TooLarge,
                    path.string() + ": exceeds " + std::to_string(limit) + " bytes");
  }
  return content;
}

}  // namespace

std::string read_file(const fs::path& path, std::size_t limit) {
  return read_whole(File(path, O_RDONLY), path, limit);
}

std::string read_regular_file(const fs::path& path, std::size_t limit) {
  const File file(path, O_RDONLY | O_NONBLOCK | O_NOCTTY);  // of a FIFO too: at once
  struct stat status {};
  if (::fstat(file.descriptor(), &status) != 0)
    throw FileError(path, Step::Read, errno);
  if (!S_ISREG(status.st_mode))
    throw Failure(ErrorCode::Storage, path.string() + ": is no regular file");
  return read_whole(file, path, limit);
}

int rename_new(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0)
    return 0;
  if (errno != EINVAL && errno != ENOSYS)
    return errno;
  // Not every file system can do that; a second name is refused if there is one.
  if (::link(from.c_str(), to.c_str()) != 0)
    return errno;
  return ::unlink(from.c_str()) == 0 ? 0 : errno;
}

void sync_file(const fs::path& file) { File(file, O_RDONLY).sync(); }

void sync_folder_of(const fs::path& file) {
  File(fs::absolute(file).parent_path(), O_RDONLY | O_DIRECTORY).sync(Step::SyncFolder);
}

}  // namespace kinship::files
