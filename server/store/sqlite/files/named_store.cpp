#include "server/store/sqlite/files/named_store.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

/// Where an open file is now; " (deleted)" ends the name of one that has none.
std::string place_of(const files::File& file) {
  std::error_code error;
  return fs::read_symlink("/proc/self/fd/" + std::to_string(file.descriptor()), error).string();
}

struct stat status_of(const files::File& file) {
  struct stat status {};
  fstat(file.descriptor(), &status);
  return status;
}

/// Empty if the name leads to nothing.
std::optional<struct stat> status_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0)
    return status;
  if (errno != ENOENT && errno != ENOTDIR)
    throw files::FileError(path, files::Step::Open, errno);
  return std::nullopt;
}

std::string descriptor_of(const files::File& file) {
  return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(file.descriptor());
}

}  // namespace

bool is_of_content(StoreChange change) {
  return change == StoreChange::Truncated || change == StoreChange::Overwritten ||
         change == StoreChange::WalDamaged || change == StoreChange::WalSpent;
}

NamedStore::NamedStore(fs::path file, const files::File& open)
    : file_(std::move(file)),
      wal_(file_.string() + "-wal"),
      open_(&open),
      id_(id_of(status_of(open))),
      folder_(file_.parent_path(), O_PATH | O_DIRECTORY),
      size_(open.size()) {}

NamedStore::Id NamedStore::id_of(const struct stat& status) {
  return {status.st_dev, status.st_ino};
}

void NamedStore::note_opened() {
  size_ = open_->size();
  try {
    log_.emplace(wal_, O_RDONLY);  // SQLite's locks are on other files
    log_id_ = id_of(status_of(*log_));
  } catch (const files::FileError& error) {
    log_.reset();  // the next look says that it is missing
    if (error.reason() != ENOENT)
      throw;
  }
}

/// Also right while another program checkpoints: that writes the first page, which says how long
/// the file is, and last the end.
bool NamedStore::is_truncated(std::uint64_t size) {
  if (size >= size_) {
    size_ = size;
    return false;
  }
  constexpr std::size_t kHeader = 32, kPageSizeAt = 16, kPagesAt = 28;
  std::array<char, kHeader> header{};
  if (open_->read(header.data(), header.size(), 0) < kHeader)
    return true;
  const auto number = [&](std::size_t at, std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i)
      value = value << 8U | static_cast<std::uint8_t>(header[at + i]);
    return value;
  };
  if (size < number(kPageSizeAt, 2) * number(kPagesAt, 4))
    return true;
  size_ = size;  // somebody's VACUUM
  return false;
}

/// Whether names in the store's own folder, wherever that is now, lead to its files.
bool NamedStore::is_whole_in_folder() const {
  const auto leads_to = [&](const fs::path& path, const Id& wanted) {
    struct stat found {};
    return fstatat(folder_.descriptor(), path.filename().c_str(), &found, 0) == 0 &&
           id_of(found) == wanted;
  };
  return leads_to(file_, id_) && (!log_ || leads_to(wal_, log_id_));
}

fs::path NamedStore::folder_now() const {
  const fs::path place = place_of(folder_);
  const auto found = status_of(place);
  return found && id_of(*found) == id_of(status_of(folder_)) ? place : fs::path();
}

bool NamedStore::has_name() const { return status_of(*open_).st_nlink > 0; }

std::string NamedStore::open_files() const {
  return descriptor_of(*open_) + " (the file)" +
         (log_ ? " and " + descriptor_of(*log_) + " (its WAL)" : "");
}

NamedStore::Finding NamedStore::look_at_file() {
  const auto found = status_of(file_);
  if (!found || id_of(*found) != id_) {
    if (is_whole_in_folder()) {
      const fs::path now = folder_now();
      return {StoreChange::FolderGone,
              now.empty() ? "another file system is mounted over its folder, it is whole below that"
                          : "its folder is '" + now.string() + "' now, it is whole there"};
    }
    if (!has_name())
      return {StoreChange::FileGone,
              found ? "another file was put in its place" : "it was removed"};
    return {StoreChange::FileGone,
            (found ? "another file has its name, it is '" : "it was moved, it is '") +
                place_of(*open_) + "' now"};
  }
  if (is_truncated(static_cast<std::uint64_t>(found->st_size)))
    return {StoreChange::Truncated,
            "it was truncated to " + std::to_string(found->st_size) + " bytes"};
  return {};
}

NamedStore::Finding NamedStore::look() {
  if (Finding found = look_at_file(); found.change != StoreChange::None)
    return found;
  const auto wal = status_of(wal_);
  if (!wal)
    return {StoreChange::WalGone, "its WAL '" + wal_.string() + "' was removed"};
  if (!log_ || id_of(*wal) != log_id_)
    return {StoreChange::WalReplaced,
            "another file has the name of its WAL, '" + wal_.string() + "'"};
  return {};
}

NamedStore::Finding NamedStore::look_closed() {
  std::error_code none;
  Finding found = look();
  const bool is_no_wal =
      found.change == StoreChange::WalGone ||
      (found.change == StoreChange::WalReplaced && fs::file_size(wal_, none) == 0);
  return is_no_wal ? Finding{} : found;
}

}  // namespace kinship::store
