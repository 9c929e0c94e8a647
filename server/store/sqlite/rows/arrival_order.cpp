#include "server/store/sqlite/rows/arrival_order.hpp"

#include <algorithm>
#include <string>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/rows/experience_rows.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kNotAsideAttempt =
    "AND NOT EXISTS (SELECT 1 FROM set_aside WHERE kind = 2 AND set_aside.id = attempt.id) ";

void append_ids(Statement& query, std::vector<std::int64_t>& ids) {
  while (query.step())
    ids.push_back(query.column_integer(0));
}

/// The next attempts of some robots and tasks by id. Each brings its own next ones, read from an
/// index; the oldest of them all are the next of all.
std::vector<std::int64_t> next_of(Database& database, const std::vector<ExperienceKey>& keys,
                                  std::int64_t after_id, std::int64_t count) {
  std::vector<std::int64_t> ids;
  for (const ExperienceKey& key : keys) {
    const auto query = database.cached(
        "SELECT id FROM attempt INDEXED BY attempt_by_task_robot "
        "WHERE task_id = ? AND robot_id = ? AND id > ? " +
        std::string(kNotAsideAttempt) + "ORDER BY id LIMIT ?");
    query->bind_all(key.task_id, key.robot_id, after_id, count);
    append_ids(*query, ids);
  }
  std::ranges::sort(ids);
  if (std::ssize(ids) > count)
    ids.resize(static_cast<std::size_t>(count));
  return ids;
}

/// The next attempts of all by id; where their rows cannot be read, from the index.
std::vector<std::int64_t> next_of_all(Database& database, std::int64_t after_id,
                                      std::int64_t count) {
  try {
    std::vector<std::int64_t> ids;
    const auto query = database.cached("SELECT id FROM attempt WHERE id > ? " +
                                       std::string(kNotAsideAttempt) + "ORDER BY id LIMIT ?");
    query->bind_all(after_id, count);
    append_ids(*query, ids);
    return ids;
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
    return next_of(database, select_experience(database, {}, ""), after_id, count);
  }
}

}  // namespace

std::vector<std::int64_t> next_attempts(Database& database, const std::optional<Digest>& robot,
                                        std::string_view task, std::int64_t after_id,
                                        std::int64_t count) {
  return robot || !task.empty()
             ? next_of(database, select_experience(database, robot, task), after_id, count)
             : next_of_all(database, after_id, count);
}

}  // namespace kinship::store
