#include "server/store/sqlite/files/store_file.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/files/file_system.hpp"

namespace kinship::store {
namespace {

namespace fs = std::filesystem;

void require(const std::error_code& error, const fs::path& file) {
  if (error)
    refuse_store(file, error.message());
}

void make_directory(const fs::path& file, const fs::path& directory) {
  std::error_code error;
  if (!fs::exists(directory, error) && !error) {
    fs::create_directories(directory, error);
    if (!error)
      fs::permissions(directory, fs::perms::owner_all, error);
  }
  if (!error && !fs::is_directory(directory, error) && !error)
    error = std::make_error_code(std::errc::not_a_directory);
  if (error)
    refuse_store(file, "directory '" + directory.string() +
                           "': " + explain_file_error(error.value(), directory.parent_path()));
}

/// A database of another kind, or SQLite's own notation, which would be taken for names of files.
void refuse_address(const fs::path& file) {
  const std::string text = file.string();
  const std::size_t colon = text.find(':');
  const std::string scheme = text.substr(0, colon);
  const bool is_url = colon != std::string::npos && text.compare(colon, 3, "://") == 0;
  if ((is_url && !scheme.empty() && scheme.find('/') == std::string::npos) ||
      (colon != std::string::npos && (scheme == "file" || scheme.starts_with("postgres"))))
    refuse_store(file, "is an address (" + text.substr(0, colon + (is_url ? 3 : 1)) +
                           "); a store is a file of this machine");
  if (text == ":memory:")
    refuse_store(file, "would be lost with the process; a store is a file");
}

void check_header(const fs::path& file) {
  const std::string_view magic = kNewDatabase.magic;
  std::string begin(magic.size(), '\0');
  try {
    begin.resize(files::File(file, O_RDONLY).read(begin.data(), begin.size(), 0));
  } catch (const files::FileError& error) {
    refuse_store(file, error.reason_text());
  }
  if (!begin.empty() && begin != magic)
    refuse_store(
        file,
        "is no SQLite database; if it was a store: 'kinshipd repair' writes anew what can be "
        "read of it");
}

std::string version_text(int number) {
  return "SQLite " + std::to_string(number / 1'000'000) + '.' +
         std::to_string(number / 1000 % 1000) + '.' + std::to_string(number % 1000);
}

}  // namespace

void refuse_store(const fs::path& file, const std::string& why) {
  throw Failure(ErrorCode::Storage, "store '" + file.string() + "': " + why);
}

fs::path locate_store(const fs::path& file) {
  std::error_code error;
  refuse_address(file);
  const fs::path absolute = fs::absolute(file, error);
  require(error, file);
  make_directory(file, absolute.parent_path());
  fs::path located = fs::weakly_canonical(absolute, error);
  require(error, file);
  const fs::file_status status = fs::symlink_status(located, error);
  if (status.type() == fs::file_type::not_found)
    return located;
  require(error, file);
  if (fs::is_symlink(status))
    refuse_store(file, "is a link to a file that does not exist");
  if (!fs::is_regular_file(status))
    refuse_store(file, fs::is_directory(status) ? "is a directory" : "is no regular file");
  const std::uintmax_t names = fs::hard_link_count(located, error);
  require(error, file);
  if (names > 1)
    refuse_store(file, "has " + std::to_string(names) + " names (hard links), must have 1");
  // Beside a lock file, a process may hold the lock, perhaps this one: closing any descriptor of a
  // file drops all locks of the process on it, SQLite's too. Then SQLite judges the header.
  if (!fs::exists(located.string() + ".lock", error))
    check_header(located);
  return located;
}

void make_for_owner(const fs::path& file) {
  try {
    const files::File made(file, O_RDWR | O_CREAT | O_EXCL, 0600);
  } catch (const files::FileError& error) {
    if (error.reason() != EEXIST)
      refuse_store(file, error.reason_text());
  }
}

void require_writable(const fs::path& file, const fs::path& located) {
  if (access(located.c_str(), W_OK) != 0 && errno != ENOENT)
    refuse_store(file, explain_file_error(errno, located));
}

std::filesystem::path locate_servable(const std::filesystem::path& file) {
  require_library(sqlite3_libversion_number());
  std::filesystem::path located = locate_store(file);
  require_writable(file, located);
  require_local_filesystem(file, located.parent_path());
  if (is_mount_point(located))
    refuse_store(file,
                 "is mounted by itself, so that its WAL, which lies beside it, is not of the same "
                 "mount; mount the folder '" +
                     located.parent_path().string() + "' instead of the file");
  return located;
}

void require_library(int number) {
  if (number < kOldestSqlite)
    throw Failure(ErrorCode::Storage, version_text(number) + " is older than " +
                                          version_text(kOldestSqlite) +
                                          ", which a store needs; install a newer libsqlite3");
}

}  // namespace kinship::store
