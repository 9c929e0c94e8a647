#pragma once

#include <filesystem>
#include <string>

/// Files of a store whose own file is missing: it was moved, or its disk is not mounted yet.
namespace kinship::store {

/// Returns unless the store's file is missing, or empty, while its WAL, journal, high-water mark or
/// lock say that there was one: a new store in its place would be written over what they have.
/// \param located  of locate_store().
/// \throws Failure(Storage) that names them and says what to do.
void require_no_leftovers(const std::filesystem::path& located);

/// Makes room for a new store: what SQLite would take for a part of it goes to
/// FILE.replaced-<time>.wal and alike, the high-water mark is removed.
/// \throws Failure(Storage) if the store's file exists and is not empty.
void set_leftovers_aside(const std::filesystem::path& located);

/// Moves FILE-wal, FILE-shm and FILE-journal to `replaced`.wal and alike: SQLite must not find them
/// beside a new file of the name, nor under a name where it would take them for those of another.
/// \throws Failure(Storage)
void move_sidecars(const std::filesystem::path& located, const std::filesystem::path& replaced);

/// The time now, for names of files: 20261121T101500Z.
std::string time_stamp();

}  // namespace kinship::store
