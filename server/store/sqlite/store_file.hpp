#pragma once

#include <filesystem>

namespace kinship::store {

/// Where the store is, as one absolute name: links are followed, so that one file has one lock.
/// Parents are made for the owner alone; nothing else is written.
/// \throws Failure(Storage) if what is there cannot be a store: a directory, a file with a second
///         name (it would have a second lock), or one that is not empty and no SQLite database.
std::filesystem::path locate_store(const std::filesystem::path& file);

/// Makes an empty file that only its owner may read and write, unless there is one.
/// \throws Failure(Storage) if it cannot be made.
void make_for_owner(const std::filesystem::path& file);

}  // namespace kinship::store
