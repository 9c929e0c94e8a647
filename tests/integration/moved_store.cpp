#include "tests/integration/moved_store.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "server/store/sqlite/opening/connection.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/golden/golden_store.hpp"
#include "tests/support/places.hpp"

namespace kinship::test {
namespace {

constexpr std::uint64_t kFirst = 1000;  // numbers of what the golden store lacks

/// Changes contents without their checksums.
void damage(const std::filesystem::path& file) {
  store::Database database(file, store::Access::ReadWrite);
  database.execute(
      "UPDATE path SET waypoints = CAST (substr(waypoints, 1, 20) || x'A5A5' || substr(waypoints,"
      " 23) AS BLOB) WHERE id IN (SELECT max(path.id) FROM path"
      " JOIN task ON task.id = task_id WHERE name IN ('noticed', 'unnoticed') GROUP BY task_id);"
      "UPDATE scene SET scene = CAST (substr(scene, 1, 20) || x'A5A5' || substr(scene, 23) AS "
      "BLOB)");
}

std::vector<std::string> columns_of(store::Database& database, const std::string& table) {
  store::Statement query(database.connection(), "SELECT name FROM pragma_table_info(?)");
  query.bind(1, std::string_view(table));
  std::vector<std::string> columns;
  while (query.step())
    columns.emplace_back(query.column_text(0));
  return columns;
}

std::string condition_of(const std::string& table) {
  if (table == "setting")
    return "key = 'revision_floor' OR key LIKE 'note:%'";
  if (table == "audit")
    return "verb <> 'migrate-store'";
  return "TRUE";
}

}  // namespace

std::vector<Attempt> attempts_of_full_store() {
  const Digest robot = id_from<Digest>(kFirst);
  return {make_attempt(robot, "carry", kFirst), make_unsolved(robot, "carry", kFirst + 1),
          make_attempt(robot, "noticed", kFirst + 2), make_attempt(robot, "unnoticed", kFirst + 3)};
}

void make_full_store(const std::filesystem::path& file) {
  std::filesystem::copy_file(test::source_dir() + "/tests/golden/store-5.db", file);
  const AuditEntry audit = golden_audit_entry();
  {
    const auto store = store::open_sqlite_store(file);
    for (const auto& [label, number] :
         {std::pair("old_name", kFirst), std::pair("gone", kFirst + 1)})
      static_cast<void>(store->register_robot(make_robot(label, number)).value_or_throw());
    const Digest robot = id_from<Digest>(kFirst), gone = id_from<Digest>(kFirst + 1);
    std::vector<Attempt> attempts = attempts_of_full_store();
    attempts.push_back(make_attempt(robot, "noticed", kFirst + 10));
    attempts.push_back(make_attempt(robot, "unnoticed", kFirst + 11));
    attempts.push_back(make_attempt(gone, "carry", kFirst + 12));
    report(*store, attempts);
    static_cast<void>(store->rename_robot(robot, "new_name", &audit).value_or_throw());
    static_cast<void>(store->remove_robot(gone, {}, &audit).value_or_throw());
    store->put_distribution(make_distribution(robot, "carry", kFirst + 20));
    store->put_distribution(make_distribution(robot, "carry", kFirst + 20));
    static_cast<void>(store->remove_task(golden_retired_attempt().task).value_or_throw());
  }
  damage(file);
  const auto store = store::open_sqlite_store(file);
  static_cast<void>(store->read_paths(id_from<Digest>(kFirst), "noticed", {.limit = 10}));
  for (std::int64_t scene = 1; scene < 10; ++scene)
    static_cast<void>(store->read_scene(scene));
  report(*store, {make_attempt(id_from<Digest>(kFirst), "last", kFirst + 30)});
}

void make_large_store(const std::filesystem::path& file, std::uint64_t attempts) {
  const auto store = store::open_sqlite_store(file);
  const store::RobotRecord robot = make_robot("panda", 1);
  static_cast<void>(store->register_robot(robot).value_or_throw());
  std::vector<Attempt> batch;
  for (std::uint64_t number = 0; number < attempts; ++number) {
    const std::string task = "task_" + std::to_string(number % 5);
    batch.push_back(number % 4 == 3 ? make_unsolved(robot.digest, task, number)
                                    : make_attempt(robot.digest, task, number));
    if (batch.size() == 500 || number + 1 == attempts)
      report(*store, std::exchange(batch, {}));
  }
}

std::map<std::string, std::multiset<std::string>> rows_of(const std::filesystem::path& file) {
  store::Database database(file, store::Access::ReadOnly);
  std::vector<std::string> tables;
  store::Statement names(database.connection(),
                         "SELECT name FROM sqlite_master WHERE type = 'table'"
                         " AND name NOT LIKE 'sqlite_%' AND name <> 'schema_migration'");
  while (names.step())
    tables.emplace_back(names.column_text(0));
  std::map<std::string, std::multiset<std::string>> rows;
  for (const std::string& table : tables) {
    std::string row;
    for (const std::string& column : columns_of(database, table))
      row += (row.empty() ? "'" : " || ' ") + column + "=' || quote(" + column + ")";
    store::Statement query(database.connection(),
                           "SELECT " + row + " FROM " + table + " WHERE " + condition_of(table));
    while (query.step())
      rows[table].emplace(query.column_text(0));
  }
  return rows;
}

std::string differences_of(const std::filesystem::path& one, const std::filesystem::path& other) {
  auto here = rows_of(one), there = rows_of(other);
  std::set<std::string> tables;
  for (const auto& rows : {here, there})
    for (const auto& [table, some] : rows)
      tables.insert(table);
  std::string words;
  for (const std::string& table : tables)
    for (const auto& [rows, others, where] :
         {std::tuple(&here[table], &there[table], " is missing: "),
          std::tuple(&there[table], &here[table], " is too much: ")}) {
      std::vector<std::string> found;
      std::ranges::set_difference(*rows, *others, std::back_inserter(found));
      for (const std::string& row : found)
        words += table + where + row.substr(0, 300) + "\n";
    }
  return words.substr(0, 3000);
}

std::int64_t number_in(const std::filesystem::path& file, const std::string& sql) {
  try {
    return store::open_reader(file)->integer(sql);
  } catch (const Failure&) {
    return 0;
  }
}

}  // namespace kinship::test
