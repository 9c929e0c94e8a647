#include "server/store/sqlite/database/wal_file.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "server/store/sqlite/database/sqlite_error.hpp"

namespace kinship::store {
namespace {

constexpr std::size_t kBytesOfAStep = std::size_t{1} << 20U;

/// \return 0, or errno.
int write_all(int descriptor, const std::uint8_t* bytes, std::size_t size, off_t at) {
  while (size > 0) {
    const ssize_t written = pwrite(descriptor, bytes, size, at);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      return written < 0 ? errno : EIO;
    bytes += written;
    size -= static_cast<std::size_t>(written);
    at += written;
  }
  return 0;
}

/// \return 0, or errno.
int write_again(int descriptor) {
  std::vector<std::uint8_t> bytes(kBytesOfAStep);
  off_t at = 0;
  while (true) {
    const ssize_t size = pread(descriptor, bytes.data(), bytes.size(), at);
    if (size < 0 && errno == EINTR)
      continue;
    if (size < 0)
      return errno;
    if (size == 0)
      break;
    if (const int error = write_all(descriptor, bytes.data(), static_cast<std::size_t>(size), at);
        error != 0)
      return error;
    at += size;
  }
  return at == 0 || fsync(descriptor) == 0 ? 0 : errno;
}

}  // namespace

void make_wal_durable(const std::filesystem::path& file) {
  const std::string wal = file.string() + "-wal";
  const int descriptor = open(wal.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0 && errno == ENOENT)
    return;
  const int error = descriptor < 0 ? errno : write_again(descriptor);
  if (descriptor >= 0)
    close(descriptor);  // SQLite's locks are on other files
  if (error != 0)
    throw Failure(ErrorCode::Storage,
                  "'" + wal + "' cannot be made durable: " + std::strerror(error));
}

bool checkpoint(Database& database, CheckpointKind kind) {
  const int mode =
      kind == CheckpointKind::Whole ? SQLITE_CHECKPOINT_TRUNCATE : SQLITE_CHECKPOINT_PASSIVE;
  int frames = 0;
  int copied = 0;
  const int code =
      sqlite3_wal_checkpoint_v2(&database.connection(), "main", mode, &frames, &copied);
  if (code == SQLITE_BUSY)
    return false;
  if (code != SQLITE_OK)
    throw_sqlite_error(database.connection(), "checkpoint");
  return frames == copied;
}

}  // namespace kinship::store
