#pragma once

#include <filesystem>
#include <string>
#include <string_view>

/// Files with keys and certificates. Each function throws Failure that names the file and the
/// reason.
namespace kinship::security {

/// Makes a folder for its owner only (0700); the folders above it follow the umask.
/// \throws Failure(Conflict) if it exists and is not empty.
void make_private_folder(const std::filesystem::path& folder);

enum class Readers {
  Owner,     ///< 0600
  Everybody  ///< 0644, within the rights of the folder
};

/// Writes a new file, durable on return. If that fails, e.g. because the disk is full, no file is
/// left.
/// \throws Failure(Conflict) if it exists.
void write_new_file(const std::filesystem::path& file, std::string_view text, Readers readers);

/// Replaces the text of a file: a concurrent reader gets the old or the new text.
void replace_file(const std::filesystem::path& file, std::string_view text, Readers readers);

/// \throws Failure(NotFound) if there is none, Failure(TooLarge) above 1 MB.
std::string read_file(const std::filesystem::path& file);

}  // namespace kinship::security
