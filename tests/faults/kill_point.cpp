#include "tests/faults/kill_point.hpp"

#include <signal.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

namespace {

std::atomic<int> changes_left = -1;  // negative: nobody is killed

void count_change() {
  if (changes_left >= 0 && changes_left-- == 0)
    kill(getpid(), SIGKILL);
}

template <typename... Arguments>
long change(long number, Arguments... arguments) {
  count_change();
  return syscall(number, arguments...);
}

}  // namespace

// The program's own definitions go before those of the C library, also for SQLite.
// NOLINTBEGIN: names and signatures are the C library's.
extern "C" {
ssize_t write(int file, const void* bytes, size_t size) {
  return change(SYS_write, file, bytes, size);
}
ssize_t pwrite(int file, const void* bytes, size_t size, off_t at) {
  return change(SYS_pwrite64, file, bytes, size, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t size, off64_t at) {
  return change(SYS_pwrite64, file, bytes, size, at);
}
int fsync(int file) { return static_cast<int>(change(SYS_fsync, file)); }
int fdatasync(int file) { return static_cast<int>(change(SYS_fdatasync, file)); }
int ftruncate(int file, off_t size) noexcept {
  return static_cast<int>(change(SYS_ftruncate, file, size));
}
int ftruncate64(int file, off64_t size) noexcept {
  return static_cast<int>(change(SYS_ftruncate, file, size));
}
int unlink(const char* name) noexcept { return static_cast<int>(change(SYS_unlink, name)); }
int link(const char* from, const char* to) noexcept {
  return static_cast<int>(change(SYS_link, from, to));
}
int rename(const char* from, const char* to) noexcept {
  return static_cast<int>(change(SYS_rename, from, to));
}
int renameat2(int from_directory, const char* from, int to_directory, const char* to,
              unsigned flags) noexcept {
  return static_cast<int>(change(SYS_renameat2, from_directory, from, to_directory, to, flags));
}
}
// NOLINTEND

namespace kinship::test {

bool killed_before_change(int change_number, const std::function<void()>& work) {
  const pid_t child = fork();
  if (child < 0)
    throw std::runtime_error("fork failed");
  if (child == 0) {
    changes_left = change_number;
    try {
      work();
    } catch (const std::exception& exception) {
      changes_left = -1;
      std::cerr << exception.what() << '\n';
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    return true;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error("the work failed at change " + std::to_string(change_number));
  return false;
}

}  // namespace kinship::test
