#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "tests/support/child_process.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"

/// What PostgreSQL itself takes: pgbench's inserts of 8 KB, each a transaction, into a table with
/// two indexes.
namespace kinship::bench {

/// Into a database that is there. Its payload is not compressed, as paths are not.
inline void prepare_pgbench(const test::PostgresCluster& cluster, const std::string& database) {
  cluster.query(
      "CREATE TABLE bench_row (id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,"
      " uuid uuid UNIQUE, payload bytea);"
      "ALTER TABLE bench_row ALTER payload SET STORAGE EXTERNAL",
      database);
}

/// Inserts a second.
inline double pgbench_inserts_per_s(const test::PostgresCluster& cluster,
                                    const std::string& database, int clients, double seconds) {
  const std::filesystem::path script = cluster.folder() / "inserts.sql";
  std::ofstream(script) << "INSERT INTO bench_row (uuid, payload) "
                           "VALUES (gen_random_uuid(), decode(repeat('00', 8176), 'hex'));\n";
  std::ostringstream time;
  time << std::max(1.0, std::round(seconds));
  test::ChildProcess pgbench(
      {test::postgres_program("pgbench"), "--no-vacuum", "--client=" + std::to_string(clients),
       "--jobs=2", "--time=" + time.str(), "--file=" + script.string(), cluster.url(database)});
  double per_s = 0;
  for (std::string line = pgbench.read_line(); !line.empty(); line = pgbench.read_line())
    if (line.starts_with("tps = "))
      per_s = std::stod(line.substr(6));
  if (pgbench.wait() != 0 || per_s <= 0)
    throw std::runtime_error("pgbench: no result");
  return per_s;
}

}  // namespace kinship::bench
