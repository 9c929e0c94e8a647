#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "tests/support/notifying_process.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// pgbouncer in front of a cluster, pooling by transaction: two transactions of a session may go
/// over two connections, so nothing that a session set holds for the next. See missing_pgbouncer().
class PgBouncer {
 public:
  /// \param connections  to each database, shared by all sessions.
  explicit PgBouncer(const PostgresCluster& cluster, int connections = 8);

  std::string url(const std::string& database) const;
  /// From now on sessions are with another cluster; connections to the former one are closed as
  /// they become free.
  void move_to(const PostgresCluster& cluster);
  void kill();     ///< SIGKILL: all sessions end
  void restart();  ///< after kill()

 private:
  void write_settings(const PostgresCluster& cluster) const;

  TemporaryDirectory folder_;
  int connections_;
  std::unique_ptr<NotifyingProcess> process_;
};

}  // namespace kinship::test
