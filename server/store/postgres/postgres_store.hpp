#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/store/store.hpp"
#include "server/store/values/put_off_reports.hpp"

namespace kinship::store {

struct PostgresOptions {
  /// Reports that arrive while more than this is queued are answered TryAgain.
  std::size_t max_queued_bytes = std::size_t{64} << 20U;
  std::chrono::milliseconds retry_after{1000};  ///< between two tries to connect again
  /// Time limit of one statement, after which the connection is given up. Not for a COMMIT.
  std::chrono::milliseconds patience{10'000};
  /// Beyond it the least recently used distributions are deleted; 0: no limit.
  std::uint64_t max_distribution_bytes = 0;
  std::uint64_t max_paths_per_pair = 0;  ///< of a robot and task; 0: no cap
  SearchLimits searches = {};
  /// How long a report that the database did not take is answered without asking it again.
  std::chrono::milliseconds put_off_for = PutOffReports::kRemembered;
  /// Receipts are given only for commits that a synchronous standby has.
  bool require_synchronous = false;
  /// Fits may read from standbys named in the URL, see store.hpp.
  bool read_replicas = true;
  /// Takes a line when reports cannot be stored and when they can again, from a thread of the
  /// store's own; may be empty.
  std::function<void(std::string_view)> log = {};
};

/// Opens (or makes) a store in a PostgreSQL database: connects, migrates an older schema, starts
/// the thread that writes. Several servers may have it open. Destroying the store drains the queue.
/// \param url  postgresql://... , as libpq reads it.
/// \throws Failure(InvalidInput) if `url` is no connection string; Failure(Storage) if the database
///         cannot be reached, is a standby, too old, or newer than this binary. No message names a
///         password.
std::unique_ptr<Store> open_postgres_store(const std::string& url,
                                           const PostgresOptions& options = {});

}  // namespace kinship::store
