#include "proto/security/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "proto/types/failure.hpp"

namespace kinship::security {

FolderLock::FolderLock(const std::filesystem::path& folder) {
  constexpr mode_t kOwner = 0600;
  const std::filesystem::path file = folder / "lock";
  file_ = open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, kOwner);
  int locked = file_ < 0 ? -1 : 0;
  if (file_ >= 0)
    do
      locked = flock(file_, LOCK_EX);
    while (locked != 0 && errno == EINTR);
  if (locked == 0)
    return;
  const int error = errno;
  if (file_ >= 0)
    close(file_);
  throw Failure(ErrorCode::Storage,
                file.string() + ": cannot be locked: " + std::generic_category().message(error));
}

FolderLock::~FolderLock() { close(file_); }

}  // namespace kinship::security
