#include "proto/security/private_files.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <system_error>

#include "proto/files/new_file.hpp"
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

/// Runs it, and reports its failure as every function of this file does.
template <typename Use>
auto told(Use use) {
  try {
    return use();
  } catch (const files::FileError& error) {
    constexpr const char* kWhat[] = {
        "cannot be made",    "cannot be read",         "cannot be read",     "cannot be written",
        "cannot be written", "cannot be synchronized", "cannot be replaced", "cannot be locked"};
    fail(error.file(), kWhat[static_cast<std::size_t>(error.step())], error.reason());
  }
}

files::NewFileOptions options_of(Readers readers, bool may_replace) {
  return {.mode = readers == Readers::Owner ? mode_t{0600} : mode_t{0644},
          .may_replace = may_replace};
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
  told([&] { files::write_file(file, text, options_of(readers, false)); });
}

void replace_file(const std::filesystem::path& file, std::string_view text, Readers readers) {
  told([&] { files::write_file(file, text, options_of(readers, true)); });
}

std::string read_file(const std::filesystem::path& file) {
  constexpr std::size_t kMaxBytes = 1'000'000;
  return told([&] { return files::read_file(file, kMaxBytes); });
}

}  // namespace kinship::security
