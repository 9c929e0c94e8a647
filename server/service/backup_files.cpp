#include "server/service/backup_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/store/open_store.hpp"

namespace kinship::service {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "SQLite format 3";  // and a zero, which text ends with anyway
/// Of a store, where SQLite keeps it (schema/sqlite/0001_store.sql). Other programs' databases may
/// lie beside the store, too.
/// Source: sqlite.org/fileformat.html, section 1.3.
constexpr std::string_view kApplication = "KINS";
constexpr std::size_t kApplicationAt = 68;

bool is_bare(const std::string& name) {
  const auto is_letter_or_digit = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
  };
  return !name.empty() && name.size() <= kMaxBackupNameBytes && is_letter_or_digit(name.front()) &&
         std::ranges::all_of(name, [&](char c) {
           return is_letter_or_digit(c) || c == '_' || c == '.' || c == '-';
         });
}

/// A file that is being written, or lies beside one that is.
bool is_unfinished(const std::string& name) {
  return std::ranges::any_of(
      std::initializer_list<const char*>{".part", "-wal", "-shm", "-journal"},
      [&](const char* suffix) { return name.ends_with(suffix); });
}

Error no_backup(const std::string& name) {
  return {ErrorCode::NotFound, "no backup '" + name + "' (see: kinship backup list)"};
}

}  // namespace

std::uint64_t free_bytes(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  return error ? 0 : space.available;
}

std::optional<Error> find_name_fault(const std::string& name, const fs::path& store_file) {
  const auto refused = [&name](const std::string& why) {
    return Error{ErrorCode::InvalidInput, "backup '" + name + "': " + why};
  };
  if (!is_bare(name))
    return refused("is no bare name: 1 to " + std::to_string(kMaxBackupNameBytes) +
                   " of A-Z a-z 0-9 _ . -, beginning with a letter or digit. Backups are in the "
                   "server's folder (kinshipd --backup-folder) alone");
  // SQLite's companions of the store come and go beside it, its lock stays, and copies that a
  // migration keeps have their names from it too.
  if (name.starts_with(store_file.filename().string()))
    return refused("is a name of the store '" + store_file.string() + "'");
  if (is_unfinished(name))
    return refused("is the name of something that is being written");
  return std::nullopt;
}

Result<fs::path> folder_of(const BackupPlace& place, const fs::path& store_file) {
  if (!place.folder.empty())
    return place.folder;
  if (store::kind_of_store(store_file.string()).value_or_throw() ==
      store::StoreKind::PostgresDatabase)
    return invalid_input("this server has no folder of backups, as its store is the database '" +
                         store_file.string() + "'; kinshipd --backup-folder FOLDER names one");
  return fs::absolute(store_file).parent_path();
}

std::vector<BackupSummary> find_backups(const fs::path& folder, const fs::path& store_file) {
  std::vector<BackupSummary> backups;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (auto file = BackupFile::open(folder, entry->path().filename().string(), store_file))
      backups.push_back(file->summary());
  if (error)
    throw Failure(ErrorCode::Storage,
                  "folder of backups '" + folder.string() + "': " + error.message());
  std::ranges::sort(backups, [](const BackupSummary& a, const BackupSummary& b) {
    return std::pair(b.modified_ms, a.name) < std::pair(a.modified_ms, b.name);
  });
  return backups;
}

Result<BackupFile> BackupFile::open(const fs::path& folder, const std::string& name,
                                    const fs::path& store_file) {
  if (auto fault = find_name_fault(name, store_file))
    return *std::move(fault);
  // Without waiting for the other end of a pipe, whose name may be there.
  BackupFile file(::open((folder / name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK),
                  {.name = name});
  struct stat status {};
  if (file.descriptor_ < 0 || fstat(file.descriptor_, &status) != 0 || !S_ISREG(status.st_mode))
    return no_backup(name);
  std::array<char, kApplicationAt + kApplication.size()> begin{};
  if (pread(file.descriptor_, begin.data(), begin.size(), 0) != std::ssize(begin) ||
      std::string_view(begin.data(), kMagic.size()) != kMagic ||
      std::string_view(begin.data() + kApplicationAt, kApplication.size()) != kApplication)
    return no_backup(name);
  constexpr std::int64_t kMilli = 1000, kNanosOfMilli = 1'000'000;
  file.summary_.bytes = static_cast<std::uint64_t>(status.st_size);
  file.summary_.modified_ms =
      status.st_mtim.tv_sec * kMilli + status.st_mtim.tv_nsec / kNanosOfMilli;
  return file;
}

BackupFile::BackupFile(int descriptor, BackupSummary summary)
    : descriptor_(descriptor), summary_(std::move(summary)) {}

BackupFile::BackupFile(BackupFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), summary_(std::move(other.summary_)) {}

BackupFile::~BackupFile() {
  if (descriptor_ >= 0)
    close(descriptor_);
}

std::vector<std::uint8_t> BackupFile::read(std::uint64_t begin, std::size_t most) const {
  std::vector<std::uint8_t> bytes(most);
  std::size_t size = 0;
  while (size < most) {
    const ssize_t read =
        pread(descriptor_, bytes.data() + size, most - size, static_cast<off_t>(begin + size));
    if (read < 0 && errno == EINTR)
      continue;
    if (read < 0)
      throw Failure(ErrorCode::Storage,
                    "backup '" + summary_.name + "': cannot be read: " + std::strerror(errno));
    if (read == 0)
      break;
    size += static_cast<std::size_t>(read);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace kinship::service
