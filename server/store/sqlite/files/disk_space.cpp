#include "server/store/sqlite/files/disk_space.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>

namespace kinship::store {
namespace {

/// The topmost folder of the file system that a folder is on.
std::filesystem::path mount_point(std::filesystem::path directory) {
  struct stat inside {};
  struct stat above {};
  while (directory.has_relative_path() && stat(directory.c_str(), &inside) == 0 &&
         stat(directory.parent_path().c_str(), &above) == 0 && inside.st_dev == above.st_dev)
    directory = directory.parent_path();
  return directory;
}

std::string megabytes(std::uint64_t bytes) {
  constexpr std::uint64_t kMega = std::uint64_t{1} << 20U;
  return std::to_string(bytes / kMega) + " MB";
}

/// Makes a file of this size with room of its own on the disk.
bool allocate_file(const std::filesystem::path& file, std::uint64_t bytes) {
  constexpr mode_t kOwnerOnly = 0600;
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kOwnerOnly);
  if (descriptor < 0)
    return false;
  const auto size = static_cast<off_t>(bytes);
  const bool done = posix_fallocate(descriptor, 0, size) == 0 && ftruncate(descriptor, size) == 0;
  close(descriptor);
  return done;
}

}  // namespace

DiskSpace::DiskSpace(const std::filesystem::path& file, std::uint64_t watermark_bytes,
                     std::uint64_t ballast_bytes)
    : directory_(file.parent_path()),
      ballast_(file.string() + ".ballast"),
      watermark_bytes_(watermark_bytes),
      ballast_bytes_(ballast_bytes),
      file_system_(mount_point(directory_).string()) {
  if (ballast_bytes_ == 0) {
    unlink(ballast_.c_str());
    return;
  }
  std::error_code error;
  has_ballast_ = std::filesystem::file_size(ballast_, error) == ballast_bytes_ && !error;
  if (!has_ballast_ && may_take_ballast())
    take_ballast();
}

std::optional<std::uint64_t> DiskSpace::free_bytes() const {
  struct statvfs space {};
  if (statvfs(directory_.c_str(), &space) != 0)
    return std::nullopt;
  return std::uint64_t{space.f_bavail} * space.f_frsize;
}

std::string DiskSpace::shortage() const {
  if (watermark_bytes_ == 0)
    return "";
  const std::optional<std::uint64_t> free = free_bytes();
  if (!free || *free >= watermark_bytes_)
    return "";
  return "the file system at '" + file_system_ + "' has " + megabytes(*free) + " (" +
         std::to_string(*free) + " bytes) free; below " + megabytes(watermark_bytes_) +
         " no report is taken";
}

std::string DiskSpace::missing_ballast() const {
  if (ballast_bytes_ == 0 || has_ballast_)
    return "";
  return "the ballast of " + megabytes(ballast_bytes_) + " is given up until the file system at '" +
         file_system_ + "' has room for it";
}

bool DiskSpace::may_take_ballast() const {
  if (ballast_bytes_ == 0 || has_ballast_)
    return false;
  const std::optional<std::uint64_t> free = free_bytes();
  // Room freed by a checkpoint for a moment does not count: the ballast would come and go.
  return free && *free >= watermark_bytes_ + 2 * ballast_bytes_;
}

void DiskSpace::take_ballast() {
  has_ballast_ = allocate_file(ballast_, ballast_bytes_);
  if (!has_ballast_)
    unlink(ballast_.c_str());
}

void DiskSpace::release_ballast_if_short() {
  const std::optional<std::uint64_t> free = free_bytes();
  if (!has_ballast_ || !free || *free >= std::max(watermark_bytes_, ballast_bytes_))
    return;
  unlink(ballast_.c_str());
  has_ballast_ = false;
}

}  // namespace kinship::store
