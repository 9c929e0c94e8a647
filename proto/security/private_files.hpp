#pragma once

#include <filesystem>
#include <string>
#include <string_view>

/// Files that hold keys and what vouches for them. Each function throws Failure that names the file
/// and the reason.
namespace kinship::security {

/// A folder for its owner only (0700), with folders above it as the umask has them.
/// \throws Failure(Conflict) if it is there and has anything in it.
void make_private_folder(const std::filesystem::path& folder);

enum class Readers {
  Owner,     ///< 0600
  Everybody  ///< 0644, as far as the folder lets them
};

/// A file that was not there before; what it holds is on the disk then. If it cannot be written,
/// e.g. as the disk is full, nothing is left of it.
/// \throws Failure(Conflict) if it is there.
void write_new_file(const std::filesystem::path& file, std::string_view text, Readers readers);

/// The file with another text: who reads it meanwhile has the old or the new one.
void replace_file(const std::filesystem::path& file, std::string_view text, Readers readers);

/// \throws Failure(NotFound) if there is none, Failure(TooLarge) above 1 MB.
std::string read_file(const std::filesystem::path& file);

}  // namespace kinship::security
