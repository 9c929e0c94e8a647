#include "proto/files/new_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <ctime>
#include <optional>
#include <set>
#include <utility>

#include "proto/types/uuid.hpp"

namespace kinship::files {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kInfix = ".kinship-";
constexpr std::string_view kSuffix = ".part";
constexpr std::size_t kDigits = 8;
constexpr std::size_t kEndBytes = kInfix.size() + kDigits + kSuffix.size();

bool is_end_of_part(std::string_view end) {
  return end.size() == kEndBytes && end.starts_with(kInfix) && end.ends_with(kSuffix) &&
         end.substr(kInfix.size(), kDigits).find_first_not_of("0123456789abcdef") ==
             std::string_view::npos;
}

/// Names of the parts of `file` in its folder that are there, or whose sidecars are.
std::set<std::string> parts_of(const fs::path& file) {
  const std::string begin = file.filename().string();
  std::set<std::string> parts;
  std::error_code error;
  for (fs::directory_iterator entry(fs::absolute(file).parent_path(), error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(begin) && is_end_of_part(name.substr(begin.size(), kEndBytes)))
      parts.insert(name.substr(0, begin.size() + kEndBytes));
  }
  return parts;
}

/// Whether the open file still has this name: its owner may have given it another one.
bool is_named(const File& open, const fs::path& name) {
  struct stat open_file {};
  struct stat named_file {};
  return fstat(open.descriptor(), &open_file) == 0 && lstat(name.c_str(), &named_file) == 0 &&
         open_file.st_dev == named_file.st_dev && open_file.st_ino == named_file.st_ino;
}

/// Whether the file is one that this program began.
bool is_ours(const File& open, std::string_view magic) {
  struct stat status {};
  if (fstat(open.descriptor(), &status) != 0 || !S_ISREG(status.st_mode) ||
      status.st_uid != geteuid())
    return false;
  std::string begin(magic.size(), '\0');
  return status.st_size == 0 ||
         (open.read(begin.data(), begin.size(), 0) == begin.size() && begin == magic);
}

void remove_sidecars(const fs::path& part, const NewFileOptions& options) {
  for (const char* const sidecar : options.sidecars)
    unlink((part.string() + sidecar).c_str());
}

/// \throws FileError, a Conflict, if another process is writing it.
void remove_leftover(const fs::path& file, const fs::path& part, const NewFileOptions& options) {
  std::optional<File> open;
  try {
    open.emplace(part, O_RDWR | O_NOFOLLOW | O_NONBLOCK);
  } catch (const FileError& error) {
    if (error.reason() == ENOENT)  // its process was killed while it removed it
      remove_sidecars(part, options);
    return;
  }
  if (!is_ours(*open, options.magic))
    return;
  if (!open->try_lock())
    throw FileError(file, Step::Lock, EWOULDBLOCK);
  if (!is_named(*open, part))
    return;
  unlink(part.c_str());
  remove_sidecars(part, options);
}

}  // namespace

NewFile::NewFile(fs::path file, const NewFileOptions& options)
    : file_(std::move(file)), options_(options), open_(make_part()) {}

File NewFile::make_part() {
  std::error_code error;
  if (!options_.may_replace && fs::exists(fs::symlink_status(file_, error)))
    throw FileError(file_, Step::Make, EEXIST);
  const bool is_exclusive = !options_.magic.empty();
  if (is_exclusive)
    for (const std::string& part : parts_of(file_))
      remove_leftover(file_, fs::path(file_).replace_filename(part), options_);
  part_ = file_;
  part_ += std::string(kInfix) + Uuid::random().text().substr(0, kDigits) + std::string(kSuffix);
  File part(part_, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW, options_.mode, file_);
  try {
    if (is_exclusive && !part.try_lock())  // another process took it for a leftover
      throw FileError(file_, Step::Lock, EWOULDBLOCK);
  } catch (const FileError&) {
    unlink(part_.c_str());
    throw;
  }
  return part;
}

NewFile::~NewFile() {
  if (is_published_)
    return;
  unlink(part_.c_str());
  remove_sidecars(part_, options_);
}

void NewFile::write(std::string_view content) const {
  open_.write(content, open_.size());
  // The system's own marks come from a clock that stands still for up to 10 ms: files written
  // meanwhile would have no order.
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  const timespec accessed_and_written[] = {{0, UTIME_OMIT}, now};
  if (::futimens(open_.descriptor(), accessed_and_written) != 0)
    throw FileError(file_, Step::Write, errno);
}

void NewFile::publish() {
  if (options_.is_durable)
    sync();
  int error = 0;
  if (!options_.may_replace)
    error = rename_new(part_, file_);
  else if (std::rename(part_.c_str(), file_.c_str()) != 0)
    error = errno;
  if (error != 0)
    throw FileError(file_, error == EEXIST ? Step::Make : Step::Name, error);
  is_published_ = true;
  if (options_.is_durable)
    sync_folder_of(file_);
}

void write_file(const fs::path& file, std::string_view content, const NewFileOptions& options) {
  NewFile whole(file, options);
  whole.write(content);
  whole.publish();
}

bool is_part(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.size() > kEndBytes && is_end_of_part(name.substr(name.size() - kEndBytes));
}

}  // namespace kinship::files
