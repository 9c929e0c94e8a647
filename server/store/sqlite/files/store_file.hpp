#pragma once

#include <filesystem>
#include <string>

#include "proto/files/lock_file.hpp"
#include "proto/files/new_file.hpp"

namespace kinship::store {

/// The files that SQLite keeps beside a database.
inline constexpr const char* kCompanions[] = {"-wal", "-shm", "-journal"};

/// A database that is written as a file of another name until it is complete, for its owner alone.
inline constexpr files::NewFileOptions kNewDatabase{
    .magic = std::string_view("SQLite format 3\0", 16), .sidecars = kCompanions};

/// Where the store is, as one absolute name: links are followed, so that one file has one lock.
/// Parents are made for the owner alone; nothing else is written.
/// \throws Failure(Storage) if what is there cannot be a store: a directory, a file with a second
///         name (it would have a second lock), or one that is not empty and no SQLite database.
std::filesystem::path locate_store(const std::filesystem::path& file);

/// Nothing if this process may write the store, or none is there.
/// \param located  of locate_store.
/// \throws Failure(Storage) with what to change, if not.
void require_writable(const std::filesystem::path& file, const std::filesystem::path& located);

/// \throws Failure(Storage) that says of the store what is in the way.
[[noreturn]] void refuse_store(const std::filesystem::path& file, const std::string& why);

/// Takes the store's lock, the file FILE.lock: one process writes one store.
/// \throws Failure(Unavailable) that names the process that has it, Failure(Storage) if there can
/// be
///         no lock.
files::LockFile lock_store(const std::filesystem::path& located);

/// Makes an empty file that only its owner may read and write, unless there is one.
/// \throws Failure(Storage) if it cannot be made.
void make_for_owner(const std::filesystem::path& file);

/// The same of a store that a server is to open: with this library, on this file system.
/// \throws Failure(Storage)
std::filesystem::path locate_servable(const std::filesystem::path& file);

/// The SQLite that the schema needs (STRICT tables, 3.37.0) as sqlite3_libversion_number() has it.
inline constexpr int kOldestSqlite = 3'037'000;

/// Nothing for an SQLite that can serve a store.
/// \param number  sqlite3_libversion_number(): major * 1'000'000 + minor * 1000 + patch
/// \throws Failure(Storage) with both versions for an older one.
void require_library(int number);

/// What to mind with this SQLite; empty if nothing. Before 3.51.3 a WAL may be corrupted when one
/// process writes and another checkpoints.
std::string library_advice(int number);

}  // namespace kinship::store
