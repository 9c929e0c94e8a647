#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>

#include "tests/faults/simulated_disk.hpp"

namespace {

using kinship::test::SimulatedDisk;

/// What the disk makes of a call, or the call itself while there is none.
template <typename OnDisk>
long ask(const SimulatedDisk::Call& call, OnDisk on_disk) {
  SimulatedDisk* const disk = SimulatedDisk::active();
  return disk == nullptr ? call() : on_disk(*disk, call);
}

int opened(const char* name, int flags, mode_t mode) {
  return static_cast<int>(
      ask([=] { return syscall(SYS_openat, AT_FDCWD, name, flags | O_LARGEFILE, mode); },
          [=](SimulatedDisk& disk, const auto& call) { return disk.open(name, flags, call); }));
}

ssize_t written(int file, const void* bytes, size_t size, off_t at) {
  return ask([=] { return syscall(SYS_pwrite64, file, bytes, size, at); },
             [=](SimulatedDisk& disk, const auto& call) {
               return disk.write(file, bytes, size, at, call);
             });
}

int truncated(int file, off_t size) {
  return static_cast<int>(
      ask([=] { return syscall(SYS_ftruncate, file, size); },
          [=](SimulatedDisk& disk, const auto& call) { return disk.truncate(file, size, call); }));
}

int synced(long number, int file) {
  return static_cast<int>(
      ask([=] { return syscall(number, file); },
          [=](SimulatedDisk& disk, const auto& call) { return disk.sync(file, call); }));
}

int unlinked(const char* name) {
  return static_cast<int>(
      ask([=] { return syscall(SYS_unlink, name); },
          [=](SimulatedDisk& disk, const auto& call) { return disk.unlink(name, call); }));
}

int renamed(int from_directory, const char* from, int to_directory, const char* to,
            unsigned flags) {
  return static_cast<int>(
      ask([=] { return syscall(SYS_renameat2, from_directory, from, to_directory, to, flags); },
          [=](SimulatedDisk& disk, const auto& call) {
            return disk.rename(from, to, (flags & RENAME_EXCHANGE) != 0, call);
          }));
}

/// The mode is there only for who makes a file.
mode_t mode_of(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

// The program's own definitions go before those of the C library, also for SQLite.
// NOLINTBEGIN: names and signatures are the C library's.
extern "C" {
int open(const char* name, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return opened(name, flags, mode);
}
int open64(const char* name, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return opened(name, flags, mode);
}
ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  return written(file, bytes, size, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  return written(file, bytes, size, at);
}
int fsync(int file) { return synced(SYS_fsync, file); }
int fdatasync(int file) { return synced(SYS_fdatasync, file); }
int ftruncate(int file, off_t size) noexcept { return truncated(file, size); }
int ftruncate64(int file, off64_t size) noexcept { return truncated(file, size); }
int posix_fallocate(int file, off_t at, off_t size) {
  return static_cast<int>(ask(
      [=] { return syscall(SYS_fallocate, file, 0, at, size) == 0 ? 0L : long{errno}; },
      [=](SimulatedDisk& disk, const auto& call) { return disk.allocate(file, at + size, call); }));
}
int unlink(const char* name) noexcept { return unlinked(name); }
int remove(const char* name) noexcept {
  struct stat status {};
  if (lstat(name, &status) == 0 && S_ISDIR(status.st_mode))
    return static_cast<int>(syscall(SYS_rmdir, name));
  return unlinked(name);
}
int link(const char* from, const char* to) noexcept {
  return static_cast<int>(
      ask([=] { return syscall(SYS_link, from, to); },
          [=](SimulatedDisk& disk, const auto& call) { return disk.link(from, to, call); }));
}
int rename(const char* from, const char* to) noexcept {
  return renamed(AT_FDCWD, from, AT_FDCWD, to, 0);
}
int renameat2(int from_directory, const char* from, int to_directory, const char* to,
              unsigned flags) noexcept {
  return renamed(from_directory, from, to_directory, to, flags);
}
int statvfs(const char* name, struct statvfs* space) noexcept {
  SimulatedDisk* const disk = SimulatedDisk::active();
  const auto room = disk == nullptr ? std::nullopt : disk->room(name);
  if (!room) {
    using Statvfs = int (*)(const char*, struct statvfs*);
    static const auto kReal = reinterpret_cast<Statvfs>(dlsym(RTLD_NEXT, "statvfs"));
    return kReal(name, space);
  }
  *space = {};
  space->f_bsize = space->f_frsize = 1;
  space->f_bfree = space->f_bavail = *room;
  return 0;
}
}
// NOLINTEND
