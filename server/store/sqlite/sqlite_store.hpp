#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>

#include "server/store/store.hpp"

namespace kinship::store {

struct SqliteOptions {
  /// Reports that come while more than this waits to be written are answered TryAgain.
  std::size_t max_queued_bytes = std::size_t{64} << 20U;
  std::chrono::milliseconds retry_after{1000};  ///< between two tries to reopen a failed database
  std::size_t scrub_bytes_per_s = 4'000'000;    ///< of the search for damage; 0: none
  /// Takes a line when damage is found, from a thread of the store's own; may be empty.
  std::function<void(std::string_view)> log = {};
};

/// Opens (or makes) a store in an SQLite file: takes the lock file, migrates an older schema,
/// starts the writer thread. Destroying the store drains the queue.
/// \throws Failure(Unavailable) if another server has it open; Failure(Storage) if the file is
///         no Kinship store (or a directory, or has hard links), is newer than this binary, or
///         cannot be opened. Every message names the file.
std::unique_ptr<Store> open_sqlite_store(const std::filesystem::path& file,
                                         const SqliteOptions& options = {});

}  // namespace kinship::store
