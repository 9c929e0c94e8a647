#pragma once

#include <filesystem>
#include <memory>

#include "server/store/store.hpp"

namespace kinship::store {

/// Opens (or makes) a store in an SQLite file: takes the lock file, migrates an older schema,
/// starts the writer thread. Destroying the store drains the queue.
/// \throws Failure(Unavailable) if another server has it open; Failure(Storage) if the file is
///         no Kinship store, is newer than this binary, or cannot be opened.
std::unique_ptr<Store> open_sqlite_store(const std::filesystem::path& file);

}  // namespace kinship::store
