#include "tests/support/locked_table.hpp"

#include <libpq-fe.h>

#include <stdexcept>

#include "tests/support/postgres_query.hpp"

namespace kinship::test {

/// Its end undoes its transaction, and with that the lock.
struct LockedTable::Session {
  explicit Session(const std::string& url) : connection(PQconnectdb(url.c_str()), PQfinish) {}
  std::unique_ptr<PGconn, decltype(&PQfinish)> connection;
};

LockedTable::LockedTable(const std::string& url, const std::string& table)
    : url_(url), table_(table), session_(std::make_unique<Session>(url)) {
  const std::string sql = "BEGIN; LOCK TABLE " + table + " IN ACCESS EXCLUSIVE MODE";
  const std::unique_ptr<PGresult, decltype(&PQclear)> done(
      PQexec(session_->connection.get(), sql.c_str()), PQclear);
  if (PQresultStatus(done.get()) != PGRES_COMMAND_OK)
    throw std::runtime_error(sql + ": " + PQerrorMessage(session_->connection.get()));
}

LockedTable::~LockedTable() = default;

void LockedTable::wait_until_wanted_by(int sessions) const {
  wait_until_true(url_, "SELECT count(*) >= " + std::to_string(sessions) +
                            " FROM pg_locks WHERE NOT granted AND relation = '" + table_ +
                            "'::regclass");
}

}  // namespace kinship::test
