#include "server/store/tables/tasks.hpp"

namespace kinship::store {

std::int64_t ensure_task(Session& session, std::string_view task) {
  constexpr std::string_view kFind = "SELECT id FROM task WHERE name = $1";
  if (const std::optional<std::int64_t> id = session.find_integer(kFind, task))
    return *id;
  session.query("INSERT INTO task (name) VALUES ($1) ON CONFLICT (name) DO NOTHING", task);
  return session.find_integer(kFind, task).value();
}

}  // namespace kinship::store
