#include "tests/support/pgbouncer.hpp"

#include <csignal>
#include <fstream>
#include <stdexcept>

#include "tests/support/postgres_programs.hpp"

namespace kinship::test {

PgBouncer::PgBouncer(const PostgresCluster& cluster, int connections) : connections_(connections) {
  give_to_postgres(folder_.path());
  write_settings(cluster);
  restart();
}

std::string PgBouncer::url(const std::string& database) const {
  return "postgresql://kinship@/" + database + "?host=" + folder_.path().string() + "&port=6432";
}

void PgBouncer::move_to(const PostgresCluster& cluster) {
  write_settings(cluster);
  process_->forget_readiness();
  process_->signal(SIGHUP);
  process_->wait_until_ready();
}

void PgBouncer::kill() { process_->kill_all(); }

void PgBouncer::restart() {
  process_ = std::make_unique<NotifyingProcess>(
      as_postgres({pgbouncer_program(), folder_ / "pgbouncer.ini"}), folder_ / "ready",
      folder_ / "log");
  process_->wait_until_ready();
}

void PgBouncer::write_settings(const PostgresCluster& cluster) const {
  std::ofstream file(folder_ / "pgbouncer.ini");
  file << "[databases]\n"
       << "* = host=" << cluster.folder().string() << " port=5432 user=kinship\n"
       << "[pgbouncer]\n"
       << "unix_socket_dir = " << folder_.path().string() << "\n"
       << "listen_port = 6432\n"
       << "auth_type = any\n"
       << "pool_mode = transaction\n"
       << "max_client_conn = 1000\n"
       << "default_pool_size = " << connections_ << "\n"
       << "server_login_retry = 0.1\n";
  if (!file.flush())
    throw std::runtime_error("cannot write " + (folder_ / "pgbouncer.ini").string());
}

}  // namespace kinship::test
