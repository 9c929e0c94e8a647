#include "proto/security/private_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "proto/types/failure.hpp"

namespace kinship::security {
namespace {

constexpr mode_t kOwnerOnlyFolder = 0700;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what, int error) {
  const ErrorCode code = error == EEXIST   ? ErrorCode::Conflict
                         : error == ENOENT ? ErrorCode::NotFound
                                           : ErrorCode::Storage;
  throw Failure(code, file.string() + ": " + what + ": " + std::generic_category().message(error));
}

/// Closes a file's descriptor.
class Descriptor {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0)
      close(number_);
  }
  int get() const noexcept { return number_; }

 private:
  int number_;
};

void write_all(const Descriptor& descriptor, std::string_view text,
               const std::filesystem::path& file) {
  while (!text.empty()) {
    const ssize_t written = write(descriptor.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR)
      continue;
    if (written < 0)
      fail(file, "cannot be written", errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  if (fsync(descriptor.get()) != 0)
    fail(file, "cannot be written", errno);
}

void sync_folder(const std::filesystem::path& folder) {
  const std::filesystem::path named = folder.empty() ? std::filesystem::path(".") : folder;
  const Descriptor descriptor(open(named.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.get() < 0 || fsync(descriptor.get()) != 0)
    fail(folder, "cannot be synchronized", errno);
}

}  // namespace

void make_private_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (!folder.parent_path().empty())
    std::filesystem::create_directories(folder.parent_path(), error);
  if (error)
    fail(folder, "cannot be made", error.value());
  if (mkdir(folder.c_str(), kOwnerOnlyFolder) == 0)
    return;
  if (errno != EEXIST || !std::filesystem::is_directory(folder, error))
    fail(folder, "cannot be made", errno);
  if (!std::filesystem::is_empty(folder, error) || error)
    throw Failure(ErrorCode::Conflict, folder.string() + ": is not empty; nothing is overwritten");
  if (chmod(folder.c_str(), kOwnerOnlyFolder) != 0)
    fail(folder, "cannot be kept from others", errno);
}

void write_new_file(const std::filesystem::path& file, std::string_view text, Readers readers) {
  constexpr mode_t kOwner = 0600;
  constexpr mode_t kAll = 0644;
  const Descriptor descriptor(open(file.c_str(),
                                   O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                                   readers == Readers::Owner ? kOwner : kAll));
  if (descriptor.get() < 0)
    fail(file, "cannot be made", errno);
  try {
    write_all(descriptor, text, file);
    sync_folder(file.parent_path());
  } catch (...) {  // half of it would take the name from what is to come
    unlink(file.c_str());
    throw;
  }
}

void replace_file(const std::filesystem::path& file, std::string_view text, Readers readers) {
  const std::filesystem::path next = file.string() + ".new-" + std::to_string(getpid());
  write_new_file(next, text, readers);
  if (rename(next.c_str(), file.c_str()) != 0) {
    const int error = errno;
    unlink(next.c_str());
    fail(file, "cannot be replaced", error);
  }
  sync_folder(file.parent_path());
}

std::string read_file(const std::filesystem::path& file) {
  constexpr std::size_t kMaxBytes = 1'000'000;
  const Descriptor descriptor(open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0)
    fail(file, "cannot be read", errno);
  std::string text(kMaxBytes + 1, '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const ssize_t count = read(descriptor.get(), text.data() + size, text.size() - size);
    if (count < 0 && errno == EINTR)
      continue;
    if (count < 0)
      fail(file, "cannot be read", errno);
    if (count == 0)
      break;
    size += static_cast<std::size_t>(count);
  }
  if (size > kMaxBytes)
    throw Failure(ErrorCode::TooLarge, file.string() + ": has more than 1 MB");
  text.resize(size);
  return text;
}

}  // namespace kinship::security
