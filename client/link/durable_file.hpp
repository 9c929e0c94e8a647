#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kinship::files {
class FileError;
}

/// Files that are whole, and mostly there after a power cut once a function has returned.
namespace kinship::link {

/// What says where reports wait.
inline constexpr std::string_view kOutboxOptions =
    "--outbox FOLDER; in Python Client(outbox=...); in C kinship_client_options.outbox";

/// For what writes a file.
/// \param what  could not be done; the reason is that of `errno`.
/// \throws Failure(Storage), always: the file, the reason, and what to name instead of a place that
///         cannot be written.
[[noreturn]] void fail_on(const std::filesystem::path& path, std::string_view what);
[[noreturn]] void fail_on(const files::FileError& error);

/// Writes a whole file durably (files::NewFile). Files of one process have times of writing in the
/// order in which they were written.
/// \throws Failure(Storage) naming the file and what the system said.
void write_durably(const std::filesystem::path& path, std::string_view content);

/// The same without fsync: after a power cut it may be the old file, or damaged.
void write_whole(const std::filesystem::path& path, std::string_view content);

/// Makes a folder, and those above it, unless they are there.
/// \throws Failure(Storage) naming the folder and what the system said.
void make_folder_durably(const std::filesystem::path& folder);

/// \throws Failure(Storage) if it cannot be read, Failure(TooLarge) above `limit` bytes.
std::string read_file(const std::filesystem::path& path, std::size_t limit);

}  // namespace kinship::link
