#include "server/store/postgres/rows/task_rows.hpp"

namespace kinship::store::postgres {

std::int64_t ensure_task(Connection& connection, std::string_view task) {
  constexpr std::string_view kFind = "SELECT id FROM task WHERE name = $1";
  if (const Rows found = connection.query(kFind, task); !found.empty())
    return found.front().column_integer(0);
  connection.query("INSERT INTO task (name) VALUES ($1) ON CONFLICT (name) DO NOTHING", task);
  return connection.query(kFind, task).front().column_integer(0);
}

}  // namespace kinship::store::postgres
