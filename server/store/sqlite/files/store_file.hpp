#pragma once

#include <filesystem>
#include <string>

#include "proto/files/new_file.hpp"

namespace kinship::store {

/// The files that SQLite keeps beside a database.
inline constexpr const char* kSidecars[] = {"-wal", "-shm", "-journal"};

/// A new database, written under another name until it is complete, readable by its owner alone.
inline constexpr files::NewFileOptions kNewDatabase{
    .magic = std::string_view("SQLite format 3\0", 16), .sidecars = kSidecars};

/// The absolute name of the store: links are followed, so that one file has one lock. Parents are
/// made for the owner alone; nothing else is written.
/// \throws Failure(Storage) if the existing file cannot be a store: a directory, a file with a
///         second name (it would have a second lock), or one that is not empty and no SQLite
///         database.
std::filesystem::path locate_store(const std::filesystem::path& file);

/// Returns if this process may write the store, or none exists.
/// \param located  of locate_store.
/// \throws Failure(Storage) with what to change, if not.
void require_writable(const std::filesystem::path& file, const std::filesystem::path& located);

/// \throws Failure(Storage) with the store's name and the reason.
[[noreturn]] void refuse_store(const std::filesystem::path& file, const std::string& why);

/// Makes an empty file that only its owner may read and write, unless it exists.
/// \throws Failure(Storage) if it cannot be made.
void make_for_owner(const std::filesystem::path& file);

/// locate_store() for a server: also checks the SQLite library, write permission and the file
/// system, and that the file is no mount point.
/// \throws Failure(Storage)
std::filesystem::path locate_servable(const std::filesystem::path& file);

/// The SQLite that the schema needs (STRICT tables, 3.37.0) as sqlite3_libversion_number() has it.
inline constexpr int kOldestSqlite = 3'037'000;

/// Returns for an SQLite that can serve a store.
/// \param number  sqlite3_libversion_number(): major * 1'000'000 + minor * 1000 + patch
/// \throws Failure(Storage) with both versions for an older one.
void require_library(int number);

}  // namespace kinship::store
