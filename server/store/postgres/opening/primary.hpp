#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "proto/types/uuid.hpp"
#include "server/store/postgres/database/connection.hpp"

namespace kinship::store::postgres {

/// The timeline of a primary: a promoted standby has a greater one than the primary before. Read
/// from the name of the current WAL file, as the control file shows it later.
/// \throws PostgresError, also on a standby.
inline std::int64_t timeline_of(Connection& connection) {
  return connection
      .query(
          "SELECT ('x' || substr(pg_walfile_name(pg_current_wal_insert_lsn()), 1, 8))"
          "::bit(32)::bigint")
      .front()
      .column_integer(0);
}

/// Whether a server is a standby, and has the row of a run.
struct StandbyState {
  bool is_standby = false;
  bool has_run = false;
};
StandbyState standby_state(Connection& connection, const Uuid& run);

/// Makes connections to the server that takes writes: of several hosts the one with the greatest
/// timeline. An old primary that returns after a promotion is never used, even while it alone
/// answers: its data is outdated. May be shared between threads.
class Primary {
 public:
  Primary(ConnectionString where, const ConnectionOptions& options);

  /// \throws PostgresError if no host can be used: gone, a standby, too old, or of an older
  ///         timeline than one seen before; with the message of each host.
  std::unique_ptr<Connection> connect();

  const std::string& description() const noexcept { return where_.description(); }
  const std::vector<ConnectionString>& hosts() const noexcept { return hosts_; }
  const ConnectionOptions& connection_options() const noexcept { return options_; }
  std::int64_t timeline() const;  ///< the greatest seen

 private:
  /// A connection to a host that takes writes, and its timeline.
  struct Found {
    std::unique_ptr<Connection> connection;
    std::int64_t timeline = 0;
  };

  std::unique_ptr<Connection> connect_to(const ConnectionString& host) const;
  Found find_newest();
  Found found(std::unique_ptr<Connection> connection) const;
  Found ask(const ConnectionString& host) const;
  void require_newest(const Found& found);

  const ConnectionString where_;
  const std::vector<ConnectionString> hosts_;
  std::atomic<bool> is_pooled_ = false;
  const ConnectionOptions options_;  // with is_pooled_

  mutable std::mutex mutex_;
  std::int64_t timeline_ = 0;                                // guarded by mutex_: the greatest met
  std::optional<ConnectionString> newest_;                   // guarded by mutex_
  std::chrono::steady_clock::time_point newest_until_ = {};  // guarded by mutex_
};

}  // namespace kinship::store::postgres
