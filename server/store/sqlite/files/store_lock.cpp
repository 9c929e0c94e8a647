#include "server/store/sqlite/files/store_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <string>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/files/file_system.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_held(const fs::path& located, const std::string& process) {
  throw Failure(ErrorCode::Unavailable,
                "store '" + located.string() + "' is open in another server, process " + process);
}

[[noreturn]] void fail_lock(const fs::path& located, const files::FileError& error) {
  throw Failure(ErrorCode::Storage, "lock file '" + error.file().string() + "': " +
                                        explain_file_error(error.reason(), located.parent_path()));
}

/// The process that has a file's lock (proc(5), /proc/locks); "unknown" if the system does not say.
std::string holder_of(const files::File& file) {
  struct stat status {};
  if (fstat(file.descriptor(), &status) != 0)
    return "unknown";
  std::ostringstream place;
  place << std::hex << std::setfill('0') << std::setw(2) << major(status.st_dev) << ':'
        << std::setw(2) << minor(status.st_dev) << ':' << std::dec << status.st_ino;
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, advice, access, process, of;
    words >> number >> kind >> advice >> access >> process >> of;
    if (kind == "FLOCK" && of == place.str())
      return process;
  }
  return "unknown";
}

fs::path lock_file_of(const fs::path& located) { return located.string() + ".lock"; }

files::LockFile lock_name(const fs::path& located) try {
  const fs::path name = lock_file_of(located);
  if (auto lock = files::LockFile::try_acquire(name))
    return *std::move(lock);
  fail_held(located, files::LockFile::holder(name));
} catch (const files::FileError& error) {
  fail_lock(located, error);
}

std::optional<files::File> lock_file(const fs::path& located) try {
  files::File file(located, O_RDONLY);
  if (!file.try_lock())
    fail_held(located, holder_of(file));
  return file;
} catch (const files::FileError& error) {
  if (error.reason() == ENOENT)
    return std::nullopt;
  fail_lock(located, error);
}

}  // namespace

// The name first: a process that has the store open itself never gets as far as the file.
StoreLock::StoreLock(const fs::path& located, const std::function<void()>& prepare)
    : name_(located), file_((prepare(), lock_file(located))) {
  if (file_)
    name_.keep();
}

StoreLock::Name::Name(const fs::path& located)
    : located_(located), is_new_(!fs::exists(lock_file_of(located))), lock_(lock_name(located)) {}

StoreLock::Name::~Name() {
  std::error_code error;
  if (is_new_ && !fs::exists(located_, error) && !error)
    fs::remove(lock_file_of(located_), error);  // while it is held
}

}  // namespace kinship::store
