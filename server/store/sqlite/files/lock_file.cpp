#include "server/store/sqlite/files/lock_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/files/file_system.hpp"

namespace kinship::store {
namespace {

std::string holder_of(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t size = pread(descriptor, text.data(), text.size(), 0);
  const std::string_view holder(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  const std::string digits(holder.substr(0, holder.find_first_not_of("0123456789")));
  return digits.empty() ? "unknown" : digits;
}

}  // namespace

LockFile::LockFile(const std::filesystem::path& store_file) {
  const std::string name = store_file.string() + ".lock";
  constexpr mode_t kOwnerOnly = 0600;
  descriptor_ = open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kOwnerOnly);
  if (descriptor_ < 0)
    throw Failure(ErrorCode::Storage, "lock file '" + name + "': " +
                                          explain_file_error(errno, store_file.parent_path()));
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const int reason = errno;
    const std::string holder = holder_of(descriptor_);
    close(descriptor_);
    if (reason == EWOULDBLOCK)
      throw Failure(ErrorCode::Unavailable, "store '" + store_file.string() +
                                                "' is open in another server, process " + holder);
    throw Failure(ErrorCode::Storage, "lock file '" + name + "': " + std::strerror(reason));
  }
  const std::string pid = std::to_string(getpid()) + "\n";
  // The process id is for people: without it (a full disk) the lock holds all the same.
  if (ftruncate(descriptor_, 0) == 0)
    static_cast<void>(pwrite(descriptor_, pid.data(), pid.size(), 0) == 0);
}

LockFile::~LockFile() { close(descriptor_); }

}  // namespace kinship::store
