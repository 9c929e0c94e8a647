#include "tests/support/postgres_query.hpp"

#include <libpq-fe.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

namespace kinship::test {
namespace {

using Connection = std::unique_ptr<PGconn, decltype(&PQfinish)>;
using QueryResult = std::unique_ptr<PGresult, decltype(&PQclear)>;

QueryResult run_query(PGconn* connection, const std::string& sql) {
  QueryResult result(PQexec(connection, sql.c_str()), PQclear);
  const ExecStatusType status = PQresultStatus(result.get());
  if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK)
    throw std::runtime_error(sql + ": " + PQerrorMessage(connection));
  return result;
}

std::string rows_of(const PGresult* result) {
  std::string rows;
  for (int row = 0; row < PQntuples(result); ++row) {
    if (row > 0)
      rows += '\n';
    for (int column = 0; column < PQnfields(result); ++column)
      rows += (column > 0 ? "\t" : "") + std::string(PQgetvalue(result, row, column));
  }
  return rows;
}

Connection connect(const std::string& url) {
  Connection connection(PQconnectdb(url.c_str()), PQfinish);
  if (PQstatus(connection.get()) != CONNECTION_OK)
    throw std::runtime_error(url + ": " + PQerrorMessage(connection.get()));
  PQsetNoticeProcessor(
      connection.get(), [](void*, const char*) {}, nullptr);
  run_query(connection.get(), "SET synchronous_commit = local");
  return connection;
}

}  // namespace

std::string query_postgres(const std::string& url, const std::string& sql) {
  const Connection connection = connect(url);
  return rows_of(run_query(connection.get(), sql).get());
}

void wait_until_true(const std::string& url, const std::string& sql) {
  using std::chrono::steady_clock;
  const auto end = steady_clock::now() + std::chrono::minutes(1);
  const Connection connection = connect(url);
  while (true) {
    const std::string answer = rows_of(run_query(connection.get(), sql).get());
    if (answer == "t")
      return;
    if (steady_clock::now() > end)
      throw std::runtime_error("not so within a minute: " + sql + ": " + answer);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));  // PostgreSQL has no event for it
  }
}

}  // namespace kinship::test
