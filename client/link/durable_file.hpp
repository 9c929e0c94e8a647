#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kinship::files {
class FileError;
}

/// Files that are complete, and most of them durable once a function has returned.
namespace kinship::link {

/// The options that set the outbox, for messages.
inline constexpr std::string_view kOutboxOptions =
    "--outbox FOLDER; in Python Client(outbox=...); in C kinship_client_options.outbox";

/// Throws the error of a file operation.
/// \param what  the operation that failed; the reason is that of `errno`.
/// \throws Failure(Storage), always: the file, the reason and, if the place cannot be written, the
///         options that set another one.
[[noreturn]] void fail_on(const std::filesystem::path& path, std::string_view what);
[[noreturn]] void fail_on(const files::FileError& error);

/// Writes a whole file durably (files::NewFile). The modification times of one process's files
/// follow the order of writing.
/// \throws Failure(Storage) naming the file and the system's error.
void write_durably(const std::filesystem::path& path, std::string_view content);

/// The same without fsync: after a power cut it may be the old file, or damaged.
void write_whole(const std::filesystem::path& path, std::string_view content);

/// Makes a folder and its missing parents.
/// \throws Failure(Storage) naming the folder and the system's error.
void make_folder_durably(const std::filesystem::path& folder);

/// Never waits, whatever is there (files::read_regular_file).
/// \throws Failure(Storage) if it cannot be read, Failure(TooLarge) above `limit` bytes.
std::string read_file(const std::filesystem::path& path, std::size_t limit);

}  // namespace kinship::link
