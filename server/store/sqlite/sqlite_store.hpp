#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>

#include "server/store/store.hpp"
#include "server/store/values/put_off_reports.hpp"

namespace kinship::store {

struct SqliteOptions {
  /// Reports that arrive while more than this is queued are answered TryAgain.
  std::size_t max_queued_bytes = std::size_t{64} << 20U;
  std::chrono::milliseconds retry_after{1000};  ///< between two tries to reopen a failed database
  std::uint64_t checkpoint_bytes = std::uint64_t{32} << 20U;  ///< of the WAL, to checkpoint it
  /// While readings keep a WAL that is longer than this, reports are answered TryAgain.
  std::uint64_t max_wal_bytes = std::uint64_t{512} << 20U;
  /// While the file system has less than this free, reports are answered TryAgain; 0: no limit.
  std::uint64_t free_space_watermark_bytes = 0;
  /// Size of FILE.ballast, which is removed when the disk is full, so that the store can still
  /// checkpoint and delete; 0: none.
  std::uint64_t ballast_bytes = 0;
  /// Beyond it the least recently used distributions are deleted; 0: no limit.
  std::uint64_t max_distribution_bytes = 0;
  /// Cap of the paths of a robot and task (rules/report_resolver.hpp); 0: none.
  std::uint64_t max_paths_per_pair = 0;
  /// A store that is to be made although files of one that is gone lie beside it, which are set
  /// aside; refused if there is a store.
  bool new_store = false;
  SearchLimits searches = {};
  /// How long a report that the database did not take is answered without asking it again.
  std::chrono::milliseconds put_off_for = PutOffReports::kRemembered;
  std::size_t scrub_bytes_per_s = 4'000'000;  ///< of the search for damage; 0: no search
  /// Takes a line when damage is found, from a thread of the store's own; may be empty.
  std::function<void(std::string_view)> log = {};
};

/// Opens (or makes) a store in an SQLite file: takes the lock file, migrates an older schema,
/// starts the writer thread. Destroying the store drains the queue.
/// \throws Failure(Unavailable) if another server has it open; Failure(Storage) if the file is
///         no Kinship store (or a directory, or has hard links), is newer than this binary, or
///         cannot be opened, or is missing while its WAL, its high-water mark or its lock is
///         there. Every message names the file.
std::unique_ptr<Store> open_sqlite_store(const std::filesystem::path& file,
                                         const SqliteOptions& options = {});

}  // namespace kinship::store
