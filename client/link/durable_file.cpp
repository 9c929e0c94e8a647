#include "client/link/durable_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <system_error>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::link {
namespace {

constexpr std::string_view kTemporarySuffix = ".tmp";

/// "FILE: cannot read: Permission denied".
std::string failure_text(const std::filesystem::path& path, std::string_view what, int reason) {
  return path.string() + ": " + std::string(what) + ": " + std::generic_category().message(reason);
}

/// As fail_on(), of a file that is only read: another folder to write to would not help.
[[noreturn]] void fail_to_read(const std::filesystem::path& path, std::string_view what) {
  throw Failure(ErrorCode::Storage, failure_text(path, what, errno));
}

/// Owner of one file descriptor.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags)
      : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0644)), path_(path) {
    if (descriptor_ >= 0)
      return;
    if (flags == O_RDONLY)
      fail_to_read(path_, "cannot open");
    fail_on(path_, "cannot open");
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { ::close(descriptor_); }

  void write(std::string_view content) const {
    while (!content.empty()) {
      const ssize_t written = ::write(descriptor_, content.data(), content.size());
      if (written < 0 && errno == EINTR)
        continue;
      if (written < 0)
        fail_on(path_, "cannot write");
      content.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  /// \return bytes read; 0 at the end.
  std::size_t read(char* buffer, std::size_t size) const {
    ssize_t count = 0;
    do
      count = ::read(descriptor_, buffer, size);
    while (count < 0 && errno == EINTR);
    if (count < 0)
      fail_to_read(path_, "cannot read");
    return static_cast<std::size_t>(count);
  }

  /// The system's own marks come from a clock that stands still for up to 10 ms: files written
  /// meanwhile would have no order.
  void mark_written_now() const {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    const timespec accessed_and_written[] = {{0, UTIME_OMIT}, now};
    if (::futimens(descriptor_, accessed_and_written) != 0)
      fail_on(path_, "cannot set its time");
  }

  void sync() const {
    if (::fsync(descriptor_) != 0)
      fail_on(path_, "cannot fsync");
  }

 private:
  int descriptor_;
  std::filesystem::path path_;
};

/// Removes a file unless it was kept, so that a failed write leaves nothing behind.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!path_.empty())
      ::unlink(path_.c_str());
  }

  const std::filesystem::path& path() const noexcept { return path_; }
  void keep() noexcept { path_.clear(); }

 private:
  std::filesystem::path path_;
};

enum class Sync { Yes, No };

void write_file(const std::filesystem::path& path, std::string_view content, Sync sync) {
  // A name of its own for every write: two writers of one file do not mix.
  TemporaryFile temporary(path.parent_path() /
                          ("." + path.filename().string() + "." + Uuid::random().text() +
                           std::string(kTemporarySuffix)));
  {
    const Descriptor file(temporary.path(), O_WRONLY | O_CREAT | O_EXCL);
    file.write(content);
    file.mark_written_now();
    if (sync == Sync::Yes)
      file.sync();
  }
  if (::rename(temporary.path().c_str(), path.c_str()) != 0)
    fail_on(path, "cannot rename to");
  temporary.keep();
  if (sync == Sync::Yes)
    Descriptor(path.parent_path(), O_RDONLY | O_DIRECTORY).sync();
}

}  // namespace

void fail_on(const std::filesystem::path& path, std::string_view what) {
  const int reason = errno;
  std::string text = failure_text(path, what, reason);
  if (reason == EROFS || reason == EACCES || reason == EPERM)
    text += "; name a folder for reports that can be written (" + std::string(kOutboxOptions) +
            "), or set XDG_STATE_HOME to one";
  throw Failure(ErrorCode::Storage, text);
}

void write_durably(const std::filesystem::path& path, std::string_view content) {
  write_file(path, content, Sync::Yes);
}

void write_whole(const std::filesystem::path& path, std::string_view content) {
  write_file(path, content, Sync::No);
}

void make_folder_durably(const std::filesystem::path& folder) {
  const std::filesystem::path path = std::filesystem::absolute(folder).lexically_normal();
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return;
  const std::filesystem::path parent = path.parent_path();
  if (parent != path)
    make_folder_durably(parent);
  if (::mkdir(path.c_str(), 0777) != 0 && errno != EEXIST)
    fail_on(path, "cannot make the folder");
  if (!std::filesystem::is_directory(path, error))  // a file, or a link to nothing
    throw Failure(ErrorCode::Storage, path.string() + ": is not a folder");
  Descriptor(parent, O_RDONLY | O_DIRECTORY).sync();
}

std::string read_file(const std::filesystem::path& path, std::size_t limit) {
  const Descriptor file(path, O_RDONLY);
  std::string content;
  char buffer[16 * 1024];
  while (const std::size_t count = file.read(buffer, sizeof buffer)) {
    content.append(buffer, count);
    if (content.size() > limit)
      throw Failure(ErrorCode::TooLarge,
                    path.string() + ": exceeds " + std::to_string(limit) + " bytes");
  }
  return content;
}

bool is_temporary(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with(".") && name.ends_with(kTemporarySuffix);
}

}  // namespace kinship::link
