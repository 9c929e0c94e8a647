#include "client/link/durable_file.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "proto/files/new_file.hpp"
#include "proto/types/failure.hpp"

namespace kinship::link {
namespace {

/// "FILE: cannot read: Permission denied".
std::string failure_text(const std::filesystem::path& path, std::string_view what, int reason) {
  return path.string() + ": " + std::string(what) + ": " + std::generic_category().message(reason);
}

void write_file(const std::filesystem::path& path, std::string_view content, bool is_durable) {
  try {
    files::write_file(path, content, {.mode = 0644, .may_replace = true, .is_durable = is_durable});
  } catch (const files::FileError& error) {
    fail_on(error);
  }
}

}  // namespace

void fail_on(const files::FileError& error) {
  constexpr const char* kWhat[] = {"cannot open",      "cannot open",  "cannot read",
                                   "cannot write",     "cannot fsync", "cannot fsync",
                                   "cannot rename to", "cannot lock"};
  errno = error.reason();
  fail_on(error.file(), kWhat[static_cast<std::size_t>(error.step())]);
}

void fail_on(const std::filesystem::path& path, std::string_view what) {
  const int reason = errno;
  std::string text = failure_text(path, what, reason);
  if (reason == EROFS || reason == EACCES || reason == EPERM)
    text += "; name a folder for reports that can be written (" + std::string(kOutboxOptions) +
            "), or set XDG_STATE_HOME to one";
  throw Failure(ErrorCode::Storage, text);
}

void write_durably(const std::filesystem::path& path, std::string_view content) {
  write_file(path, content, true);
}

void write_whole(const std::filesystem::path& path, std::string_view content) {
  write_file(path, content, false);
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
  try {
    files::sync_folder_of(path);
  } catch (const files::FileError& refused) {
    fail_on(refused);
  }
}

std::string read_file(const std::filesystem::path& path, std::size_t limit) {
  try {
    return files::read_regular_file(path, limit);
  } catch (const files::FileError& error) {  // another folder to write to would not help
    throw Failure(ErrorCode::Storage,
                  failure_text(error.file(),
                               error.step() == files::Step::Open ? "cannot open" : "cannot read",
                               error.reason()));
  }
}

}  // namespace kinship::link
