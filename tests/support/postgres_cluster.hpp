#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/notifying_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// A PostgreSQL server of a test's own, or a standby of one: a real cluster in a temporary folder,
/// which is reached over a unix socket there. No port is taken, and no cluster of the system is
/// touched. Gone on destruction, and soon after the thread that started it ends.
///
///     if (const std::string missing = missing_postgres(); !missing.empty())
///       GTEST_SKIP() << missing;
class PostgresCluster {
 public:
  struct Options {
    std::string name = "primary";                ///< cluster_name; what a standby is known by
    std::vector<std::string> settings = {};      ///< lines of postgresql.conf, "name = 'value'"
    std::filesystem::path root = memory_root();  ///< disk_root() with fsync = on to measure
  };

  PostgresCluster() : PostgresCluster(Options{}) {}
  /// initdb, and start.
  explicit PostgresCluster(const Options& options);
  /// pg_basebackup from a primary that runs, start, and wait until it streams. It is synchronous if
  /// the primary's synchronous_standby_names lists its name.
  PostgresCluster(const PostgresCluster& primary, const Options& options);
  PostgresCluster(const PostgresCluster&) = delete;
  PostgresCluster& operator=(const PostgresCluster&) = delete;
  ~PostgresCluster();

  const std::string& name() const noexcept { return name_; }
  const std::filesystem::path& folder() const noexcept {
    return folder_.path();
  }  ///< of its socket
  std::filesystem::path log() const { return folder_ / "log"; }
  bool is_running() const noexcept { return server_ && server_->is_running(); }

  /// For libpq: the database as superuser kinship, without a password.
  std::string url(const std::string& database = "postgres") const;

  /// What SQL gives, see query_postgres().
  std::string query(const std::string& sql, const std::string& database = "postgres") const;

  /// \param pattern  the database it is a copy of; nobody may be connected to that one.
  /// \return its URL.
  std::string create_database(const std::string& database,
                              const std::string& pattern = "template1") const;
  void drop_database(const std::string& database) const;  ///< with whoever is connected

  /// A setting for all sessions from now on, while it runs. What the checkpointer has to see too
  /// (synchronous_standby_names) holds a little later: give it to the constructor instead.
  void set(const std::string& setting, const std::string& value) const;

  void start();         ///< as it was before: a standby follows the same primary
  void stop();          ///< in order (fast shutdown)
  void kill();          ///< SIGKILL to all its processes at once: the host is gone, its disk is not
  void freeze() const;  ///< SIGSTOP to all its processes: it answers nothing, connections stay
  void thaw() const;

  /// Standbys: makes it a primary; returns when it takes writes.
  void promote();
  /// The process that receives the primary's log: stopped, so that the primary is ahead of it.
  void freeze_receiver() const;
  void thaw_receiver() const;
  /// SIGKILL, with what is on its way in the socket; returns when the standby has recovered.
  void kill_receiver();
  bool has_receiver() const;

  /// A primary that was killed or stopped becomes a standby of another one that was promoted:
  /// pg_rewind undoes what that one does not have; started, and streaming on return.
  void rewind_and_follow(const PostgresCluster& primary);

 private:
  std::filesystem::path data() const { return folder_ / "data"; }
  void become_standby_of(const PostgresCluster& primary);
  void wait_until_streaming_from(const PostgresCluster& primary) const;
  void free_shared_memory() const;

  std::string name_;
  TemporaryDirectory folder_;
  std::string primary_conninfo_;  // empty: never was a standby
  std::unique_ptr<NotifyingProcess> server_;
};

/// URL of whichever of two servers takes writes.
std::string url_of_either(const PostgresCluster& one, const PostgresCluster& other,
                          const std::string& database);

/// The primary's host is gone, with what it had sent and its standby had not yet received: sockets
/// of one machine would deliver that all the same. The standby can be promoted then.
void lose_primary(PostgresCluster& primary, PostgresCluster& standby);

/// Until the standby has replayed all that the primary has written by now.
void wait_until_replayed(const PostgresCluster& primary, const PostgresCluster& standby);

}  // namespace kinship::test
